#include "demo/demo_report.h"

#include <fmt/format.h>

#include "hqslam/evaluation/png.h"
#include "report/chart.h"
#include "report/density_image.h"
#include "report/report_style.h"

namespace hqslam::tools {
namespace {

std::string table_html(const DemoTable& table) {
  std::string html = "<div class=\"scroll\"><table><tr><th></th>";
  for (const std::string& column : table.columns) {
    html += fmt::format("<th>{}</th>", escape_html(column));
  }
  html += "</tr>\n";
  for (const DemoTable::Row& row : table.rows) {
    html += fmt::format("<tr><td><a href=\"{}\">{}</a></td>", escape_html(row.report),
                        escape_html(row.name));
    for (const std::string& cell : row.cells) {
      html += fmt::format("<td>{}</td>", escape_html(cell));
    }
    html += "</tr>\n";
  }
  html += "</table></div>\n<p class=\"quiet\">";
  for (const std::string& note : table.notes) {
    html += escape_html(note) + "<br>\n";
  }
  return html + "</p>\n";
}

std::string image_html(const std::string& caption, const RangeImage& image, double max_range_m) {
  return fmt::format(
      "<h2>{0}</h2>\n<img alt=\"{0}\" style=\"width:100%;height:auto;min-height:96px;"
      "image-rendering:pixelated\" src=\"data:image/png;base64,{1}\">\n",
      escape_html(caption), base64(encode_png(color_by_range(image, max_range_m))));
}

}  // namespace

std::string demo_html(const DemoTable& table,
                      const std::vector<std::pair<std::string, RangeImage>>& images,
                      double max_range_m) {
  std::string html = "<h1>hqslam demo</h1>\n" + table_html(table);
  for (const auto& [caption, image] : images) {
    html += image_html(caption, image, max_range_m);
  }
  html +=
      "<p class=\"quiet\">One scan from the middle of the drive as range images, unrolled from "
      "behind over the left, front and right: near is bright, far is dark blue, black is no "
      "return or, in the network's image, a pixel that it is not sure of.</p>\n";
  return page_html("hqslam demo", "", html);
}

}  // namespace hqslam::tools

#include <fmt/format.h>

#include "laboratory/table/table_output.h"
#include "report/chart.h"
#include "report/report_style.h"

namespace hqslam::tools {
namespace {

/// What the tables' pages add to the reports' style: they are wider.
constexpr std::string_view kTablePageStyle = R"css(
body { max-width: 84rem; }
h2 { font-size: 1.3rem; margin-top: 3.5rem; }
h3 { font-size: 1rem; margin: 2rem 0 .4rem; font-weight: 650; }
th { vertical-align: bottom; line-height: 1.25; }
td { white-space: nowrap; }
.notes { padding-left: 1.1rem; }
)css";

std::string html_of(const TextTable& table) {
  std::string html = "<div class=\"scroll\"><table><tr>";
  for (const std::string& column : table.columns) {
    html += fmt::format("<th>{}</th>", escape_html(column));
  }
  html += "</tr>\n";
  for (const std::vector<std::string>& row : table.rows) {
    html += "<tr>";
    for (const std::string& cell : row) html += fmt::format("<td>{}</td>", escape_html(cell));
    html += "</tr>\n";
  }
  return html + "</table></div>\n";
}

}  // namespace

std::string titled_table_html(const TextTable& table) {
  if (table.rows.empty()) return "";
  return fmt::format("<h3>{}</h3>\n{}", escape_html(table.title), html_of(table));
}

std::string notes_html(const std::vector<std::string>& notes) {
  std::string html = "<h2>Notes</h2>\n<ul class=\"notes quiet\">\n";
  for (const std::string& note : notes) html += fmt::format("<li>{}</li>\n", escape_html(note));
  return html + "</ul>\n";
}

std::string table_page_html(std::string_view title, std::string_view style,
                            const std::string& body) {
  return page_html("hqslam table", fmt::format("{}{}", kTablePageStyle, style),
                   fmt::format("<h1>{}</h1>\n{}", escape_html(title), body));
}

}  // namespace hqslam::tools

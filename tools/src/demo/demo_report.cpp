#include "demo/demo_report.h"

namespace hqslam::tools {

std::string demo_html(const TurningView& view, const TextTable& table,
                      const std::vector<std::string>& notes,
                      const std::vector<std::pair<std::string, RangeImage>>& images,
                      double max_range_m) {
  Page page("hqslam demo");
  page.heading(1, "hqslam demo");
  page.style(kTurningViewStyle);
  page.html(turning_view_html(view));
  page.table(table);
  page.list(notes);
  for (const auto& [caption, image] : images) {
    page.heading(2, caption);
    page.picture(color_by_range(image, max_range_m), caption, /*rows=*/true);
  }
  page.paragraph(
      "One scan from the middle of the drive as range images, unrolled from behind over the left, "
      "front and right: near is bright, far is dark blue, black is no return or, in the network's "
      "image, a pixel that it is not sure of.");
  return page.text();
}

}  // namespace hqslam::tools

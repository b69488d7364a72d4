#include "demo/demo_report.h"

#include <doctest/doctest.h>

#include "tools/parts_of_text.h"

namespace hqslam::tools {

TEST_CASE("the demo's page holds every cell, leads to every report and shows every image") {
  const TextTable table{.columns = {"", "APE, m", "a < b"},
                        .rows = {{"64 beams", "0.010", "-"}, {"16 -> 64", "0.029", "9.43 %"}},
                        .links = {"rows-64/report.html", "linear/report.html"}};
  RangeImage image(4, 8);
  image.at(1, 1) = 10.0F;
  const std::string html =
      demo_html({}, table, {"APE: what it is"}, {{"64 beams", image}, {"16 -> 64", image}}, 120.0);
  for (const char* part : {"APE, m", "a &lt; b", "0.010", "9.43 %", "rows-64/report.html",
                           "linear/report.html", "16 -&gt; 64", "APE: what it is"}) {
    CAPTURE(part);
    CHECK(holds(html, part));
  }
  CHECK(count(html, "data:image/png") == 2);
}

}  // namespace hqslam::tools

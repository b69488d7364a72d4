#include "inspect/layers_report.h"

#include <doctest/doctest.h>

#include "tools/parts_of_text.h"

namespace hqslam::tools {

TEST_CASE("no zero of a tensor's range has a sign") {
  LayersReport report;
  report.measured = report.result = RangeImage(1, 2);
  report.confidence = {0.0F, 0.0F};
  report.trace.add({"a", "", 1, 1, 2, {-0.0F, -0.0F}});
  report.trace.add({"b", "", 1, 1, 2, {-0.5F, -0.0F}});
  report.tensors = {"a", "b"};
  const std::string html = layers_html(report);
  CHECK(holds(html, "a, channel 0: 0 to 0<"));
  CHECK(holds(html, "1 channels of 1 x 2, -0.5 to 0;"));
}

}  // namespace hqslam::tools

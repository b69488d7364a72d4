#include "compare/confidence_curve.h"

#include <doctest/doctest.h>

#include "error_message.h"
#include "hqslam/core/projection.h"
#include "tools/parts_of_text.h"
#include "tools/program/untrained_weights.h"

namespace hqslam::tools {
namespace {

nn::Upsampler untrained(const std::string& kind) {
  return {nn::SuperResolver(test::untrained_weights(sensor_preset("os1-64"), kind),
                            {.least_confidence = 0.0F}),
          sensor_preset("os1-64")};
}

OrganizedCloud room() {
  RangeImage image(64, 1024);
  for (int row = 0; row < 64; ++row) {
    for (int column = 0; column < 1024; ++column) {
      image.at(row, column) =
          row < 10 && column < 200 ? 0.0F : 6.0F + 0.002F * static_cast<float>(column);
    }
  }
  return unproject(image, sensor_preset("os1-64"), CaptureTime::kMotionCorrected);
}

}  // namespace

TEST_CASE("with growing confidence points are lost, never won, and the bins hold every return") {
  ConfidenceCurve curve(untrained("du-mix"), 0.5F);
  curve.add(room());
  const std::vector<OperatingPoint> points = curve.points();
  REQUIRE(points.size() > 5);
  for (std::size_t i = 1; i < points.size(); ++i) {
    CHECK(points[i].least_confidence > points[i - 1].least_confidence);
    CHECK(points[i].missing_share >= points[i - 1].missing_share);
  }
  CHECK(points.front().missing_share < 0.01);
  CHECK(points.back().missing_share > 0.99);  // untrained: nothing is believed that much
  std::int64_t pixels = 0;
  for (const ReliabilityBin& bin : curve.reliability()) pixels += bin.pixels;
  CHECK(pixels == 48 * 1024);
  const std::string page = confidence_html(curve, "w.npz", "room");
  CHECK(missing(page, {"Can it be believed", "true return within 0.5 m"}) == "");
  CHECK_FALSE(holds(page, "nan"));
}

TEST_CASE("a network without a confidence has no curve") {
  CHECK(test::refused_with([] { ConfidenceCurve(untrained("du-or"), 0.5F); }, "du-or", "du-mix"));
}

}  // namespace hqslam::tools

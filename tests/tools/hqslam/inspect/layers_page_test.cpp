#include "inspect/layers_page.h"

#include "inspect/what_if.h"
#include "tools/page_data.h"
#include "tools/parts_of_text.h"
#include "tools/program/untrained_weights.h"

namespace hqslam::tools {
namespace {

nn::TracedTensor tensor(const std::string& name, const std::string& unit,
                        const std::array<int, 3>& shape, const std::vector<float>& values) {
  nn::TracedTensor result{name, unit, nn::TracedTensor::Values(shape[0], shape[1], shape[2])};
  std::ranges::copy(values, result.values.data());
  return result;
}

/// Two rows of two pixels, of which the second row is measured.
LayersReport example_report(const std::string& change = "q=h") {
  LayersReport report;
  report.recording = "</script>";
  const SensorModel sensor = preset_with("os1-64", 64);
  report.network = what_if(untrained_weights(sensor, "du-or"), change).description;
  report.network.measured_rows = RowSelection{1, 2};
  report.network.sensor.beam_elevation_rad = {0.1, 0.0};
  report.network.sensor.min_range_m = 0.5;
  report.measured = RangeImage(1, 2);
  report.measured.range_m = {10.0F, 20.0F};
  report.truth = RangeImage(2, 2);
  report.truth->range_m = {12.0F, 0.0F, 10.0F, 20.0F};
  report.result = *report.truth;
  report.trace.add(tensor("measured", "m", {1, 1, 2}, {10.0F, 20.0F}));
  report.trace.add(tensor("layers.0.h", "m", {1, 2, 2}, {10.0F, 10.0F, 10.0F, 21.0F}));
  report.trace.add(tensor("layers.0.z", "m", {1, 2, 2}, {11.0F, 10.0F, 13.0F, 21.0F}));
  report.confidence.assign(4, 1.0F);
  return report;
}

}  // namespace

TEST_CASE("errors of layers and of the result are those with measured rows restored") {
  const std::vector<LayerFigures> figures = layer_figures(example_report());
  REQUIRE(figures.size() == 2);
  CHECK(figures[0].name == "Layer 1");
  // Z's measured row is off by 3 m and 1 m, which is not counted; row 0 by 1 m and 10 m.
  CHECK(figures[0].error_all_m.value() == doctest::Approx(11.0 / 4.0));
  CHECK(figures[0].error_valid_m.value() == doctest::Approx(1.0 / 3.0));
  CHECK(figures[0].rms_h_z_m.value() == doctest::Approx(std::sqrt((1.0 + 9.0) / 4.0)));
  CHECK(figures[0].rms_dh_l_m.value() == doctest::Approx(std::sqrt(0.5)));
  CHECK(figures[1].name == "Result");
  CHECK(figures[1].error_all_m == 0.0);
  CHECK(figures[1].rejected == 0);
}

TEST_CASE("what a network does not have is not among the figures and images") {
  LayersReport report = example_report();
  nlohmann::json data = layers_json(report);
  CHECK_FALSE(data["layers"][0].contains("rms_h_y_m"));
  CHECK_FALSE(data["layers"][0].contains("rejected"));
  CHECK_FALSE(data["layers"][0].contains("penalty"));
  for (const auto& image : data["images"]) {
    CHECK(image["what"] != "y");
    CHECK(image["what"] != "rejected");
  }
  report.trace.add(tensor("layers.0.penalty", "", {1, 1, 1}, {0.25F}));
  report.trace.add(tensor("layers.0.y", "m", {1, 2, 2}, {10.0F, 10.0F, 10.0F, 23.0F}));
  report.trace.add(tensor("layers.0.rejected", "", {1, 2, 2}, {0.0F, 0.0F, 0.0F, 1.0F}));
  data = layers_json(report);
  CHECK(data["layers"][0]["rms_h_y_m"] == 1.0);
  CHECK(data["layers"][0]["rejected"] == 1);
  CHECK(data["layers"][0]["penalty"] == 0.25);
  report.truth.reset();
  CHECK_FALSE(layers_json(report)["layers"][0].contains("error_all_m"));
}

TEST_CASE("pixels without a return in the mask are those of the image that is filtered") {
  for (const auto& [change, first] : {std::pair("q=h", 1.0F), {"q=z", 0.0F}}) {
    LayersReport report = example_report(change);
    report.trace = {};
    report.trace.add(tensor("layers.0.h", "m", {1, 2, 2}, {10.0F, 10.0F, 10.0F, 21.0F}));
    for (const char* name : {"layers.0.z", "layers.0.y", "measured"}) {
      report.trace.add(tensor(name, "m", {1, 2, 2}, {0.0F, 10.0F, 13.0F, 21.0F}));
    }
    report.trace.add(tensor("layers.0.rejected", "", {1, 2, 2}, {0.0F, 0.0F, 0.0F, 1.0F}));
    const nlohmann::json data = layers_json(report);
    CHECK(data["network"]["filtered_iterate"] == std::string(change).substr(2));
    const auto is_mask = [](const auto& image) { return image["what"] == "rejected"; };
    const auto mask = std::ranges::find_if(data["images"], is_mask);
    CHECK(numbers_of((*mask)["values"]) == std::vector<float>{first, 1.0F, 1.0F, 2.0F});
  }
}

TEST_CASE("of the computed pixels the wrong and the missing ones are counted") {
  LayersReport report = example_report();
  report.truth->range_m = {12.0F, 5.0F, 10.0F, 20.0F};
  report.result.range_m = {14.0F, 0.0F, 10.0F, 20.0F};  // 2 m off, and empty; row 1 is measured
  report.variants = {{"b=1", *report.truth}};
  const std::vector<LayerFigures> figures = layer_figures(report);
  CHECK(figures[1].wrong_share == 1.0);
  CHECK(figures[1].missing_share == 0.5);
  CHECK(figures[2].name == "Result, b=1");
  CHECK(figures[2].wrong_share == 0.0);
  CHECK(figures[2].missing_share == 0.0);
}

TEST_CASE("a pixel's ranges are printed for every layer; one beyond the image is refused") {
  LayersReport report = example_report();
  report.pixel = {0, 0};
  CHECK(layers_json(report)["pixel"] == report.pixel);
  const std::string text = pixel_text(report);
  CHECK(holds(text, "result 12.000 m; truth 12.000 m\n"));
  CHECK(holds(text, "Layer 1    10.000 "));
  CHECK(holds(text, " 11.000 "));
  report.pixel = {2, 0};
  CHECK_THROWS_WITH_AS(pixel_text(report),
                       "inspect: pixel 2,0, expected a row of 0 to 1 and a column of 0 to 1",
                       Error);
}

TEST_CASE("a tensor that was asked for is shown channel by channel, each on its own scale") {
  LayersReport report = example_report();
  report.trace.add(tensor("a", "", {2, 1, 2}, {-0.0F, -0.0F, -0.5F, 1.5F}));
  report.tensors = {"a"};
  const nlohmann::json data = data_of(layers_html(report));
  const auto& images = data["images"];
  const auto& first = images[images.size() - 2];
  CHECK(first["group"] == "a");
  CHECK(first["low"].dump() == "0.0");  // no zero has a sign
  CHECK(images.back()["channel"] == 1);
  CHECK(images.back()["rows"] == 1);
  CHECK(images.back()["columns"] == 2);
  CHECK(images.back()["low"] == -0.5);
  CHECK(images.back()["high"] == 1.5);
  CHECK(numbers_of(images.back()["values"])[1] == doctest::Approx(1.5));
  CHECK(holds(data["subtitle"].get<std::string>(), "</script>"));
}

}  // namespace hqslam::tools

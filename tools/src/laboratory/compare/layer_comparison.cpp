#include "laboratory/compare/layer_comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace hqslam::tools {

LayerComparison::LayerComparison(nn::SuperResolver network, const SensorModel& sensor)
    : network_(std::move(network)),
      linear_(nn::interpolation_from_name("linear"), sensor, network_.description().measured_rows) {
}

RangeImage LayerComparison::restored(RangeImage image, const RangeImage& measured) const {
  const SensorModel& sensor = network_.sensor();
  for (float& range_m : image.range_m) {
    if (range_m < sensor.min_range_m || range_m > sensor.max_range_m) range_m = 0.0F;
  }
  const RowSelection rows = linear_.measured_rows();
  for (int row = 0; row < measured.rows; ++row) {
    for (int column = 0; column < measured.columns; ++column) {
      image.at(rows.offset + row * rows.stride, column) = measured.at(row, column);
    }
  }
  return image;
}

std::vector<LayerComparison::Step> LayerComparison::steps(const RangeImage& measured) {
  nn::Trace trace;
  RangeImage result = network_.run(measured, &trace).image;
  std::vector<Step> steps = {{"linear", linear_.run(measured).image}};
  for (std::size_t i = 0; i < trace.layers.size(); ++i) {
    nn::LayerTrace& layer = trace.layers[i];
    const auto add = [&](const char* iterate, RangeImage& image) {
      steps.push_back({fmt::format("layer {}: {}", i + 1, iterate), restored(image, measured)});
    };
    if (!layer.probability.empty()) {
      add("Z where p >= 0.5", layer.y);
      continue;
    }
    if (!layer.h.range_m.empty()) add("H", layer.h);
    add("Z", layer.z);
    if (!layer.rejected.empty()) add("Y", layer.y);
  }
  steps.push_back({"result", std::move(result)});
  return steps;
}

void LayerComparison::add(const OrganizedCloud& truth) {
  const OrganizedCloud measured = select_rows(truth, linear_.measured_rows());
  std::vector<Step> of_scan = steps(range_image(measured));
  sums_.resize(of_scan.size());
  for (std::size_t i = 0; i < of_scan.size(); ++i) {
    sums_[i].method = std::move(of_scan[i].name);
    add_errors({std::move(of_scan[i].image), {}}, measured, truth, linear_.sensor(), sums_[i]);
  }
  ++scans_;
}

std::vector<UpsamplingScore> LayerComparison::scores() const {
  std::vector<UpsamplingScore> scores = sums_;
  for (UpsamplingScore& score : scores) make_mean(score, scans_);
  return scores;
}

}  // namespace hqslam::tools

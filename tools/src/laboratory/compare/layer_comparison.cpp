#include "laboratory/compare/layer_comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

namespace hqslam::tools {

namespace {

/// Z where a return is likelier than none.
RangeImage likely(const nn::Trace& trace, int k) {
  RangeImage z = trace.image(fmt::format("layers.{}.z", k));
  const std::vector<float>& probability = trace.tensor("probability").values;
  for (std::size_t i = 0; i < probability.size(); ++i) {
    if (probability[i] < 0.5F) z.range_m[i] = 0.0F;
  }
  return z;
}

}  // namespace

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
  const std::array<std::pair<const char*, const char*>, 3> iterates{
      {{"H", "h"}, {"Z", "z"}, {"Y", "y"}}};
  for (int k = 0; trace.has(fmt::format("layers.{}.z", k)); ++k) {
    const auto add = [&](const char* iterate, const RangeImage& image) {
      steps.push_back({fmt::format("layer {}: {}", k + 1, iterate), restored(image, measured)});
    };
    if (trace.has("probability")) {
      add("Z where p >= 0.5", likely(trace, k));
      continue;
    }
    for (const auto& [iterate, name] : iterates) {
      const std::string tensor = fmt::format("layers.{}.{}", k, name);
      if (trace.has(tensor)) add(iterate, trace.image(tensor));
    }
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

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "two_modes_network.h"

// What every layer of the two-mode network makes of a scan, for people who want to look, and its
// parts, to be measured.
namespace hqslam::nn {

RangeImage TwoModesNetwork::in_metres(const Tensor& log_ranges) const {
  RangeImage image(rows_ * tile_.rows, columns_ * tile_.columns);
  from_tiles(log_ranges, tile_, image.range_m.data());
  for (float& range_m : image.range_m) range_m = std::exp(range_m);
  return image;
}

LayerTrace TwoModesNetwork::layer_trace(int layer) const {
  const Layer& self = layers_[layer];
  Tensor z = self.h;  // measured pixels stay
  Tensor probability = self.h;
  for (int channel = 0; channel < tile_.pixels(); ++channel) {
    for (int row = 0; row < rows_; ++row) {
      const float* valid = measured_valid_.row(channel % tile_.columns, row);
      std::copy_n(valid, columns_, probability.row(channel, row));
    }
  }
  for (std::size_t pixel = 0; pixel < computed_.size(); ++pixel) {
    const auto from = static_cast<int>(pixel);
    for (int row = 0; row < rows_; ++row) {
      std::copy_n(self.z.row(from, row), columns_, z.row(computed_[pixel].channel, row));
      std::copy_n(self.probability.row(from, row), columns_,
                  probability.row(computed_[pixel].channel, row));
    }
  }
  LayerTrace trace;
  trace.h = in_metres(self.h);
  trace.z = trace.y = in_metres(z);
  trace.probability.resize(trace.z.range_m.size());
  from_tiles(probability, tile_, trace.probability.data());
  for (std::size_t i = 0; i < trace.y.range_m.size(); ++i) {
    if (trace.probability[i] < 0.5F) trace.y.range_m[i] = 0.0F;
  }
  return trace;
}

Trace TwoModesNetwork::trace(const RangeImage& measured) {
  lift(measured, 0.5F);  // the tolerance plays no part in what is traced
  Trace trace{in_metres(layers_.front().h), {}, {}};
  for (int layer = 0; layer < static_cast<int>(layers_.size()); ++layer) {
    trace.layers.push_back(layer_trace(layer));
  }
  return trace;
}

std::vector<NetworkStep> TwoModesNetwork::steps(const RangeImage& measured) {
  constexpr float kTolerance_m = 0.5F;
  lift(measured, kTolerance_m);
  std::vector<NetworkStep> steps;
  for (int layer = 0; layer < static_cast<int>(layers_.size()); ++layer) {
    std::vector<NetworkStep> of_layer = layers_[layer].graph.steps(layers_[layer].values);
    of_layer.back().name = "head, two modes";
    of_layer.back().run = [this, layer, &measured] { say_modes(layer, measured, kTolerance_m); };
    for (NetworkStep& step : of_layer) {
      step.name = fmt::format("{}.{}", layer, step.name);
      steps.push_back(std::move(step));
    }
  }
  return steps;
}

}  // namespace hqslam::nn

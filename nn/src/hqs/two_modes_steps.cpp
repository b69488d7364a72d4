#include <fmt/format.h>

#include "two_modes_network.h"

// The parts of the two-mode network, to be measured.
namespace hqslam::nn {

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

#include "bench/network_steps.h"

#include <doctest/doctest.h>

#include "hqslam/nn/hqs/network.h"

namespace hqslam::tools {
namespace {

nn::NetworkDescription description_of(nn::NetworkKind kind) {
  nn::NetworkDescription description;
  description.kind = kind;
  description.sensor = sensor_preset("os1-64");
  description.measured_rows = selection_for(64, 16);
  description.plain.features = 8;
  return description;
}

/// `times`: how often the convolutions are there in the whole network.
void check_convolutions(const nn::NetworkDescription& description, int times) {
  const auto network = nn::make_network(description, 1024, nn::InstructionSet::kPortable, 1);
  std::int64_t multiply_adds = 0;
  std::int64_t weights = 0;
  for (const NetworkConvolution& layer : convolutions_of(description)) {
    multiply_adds += layer.multiply_adds();
    weights += layer.shape.weights();
  }
  CHECK(multiply_adds * times == network->multiply_adds());
  std::int64_t expected_weights = 0;
  for (const nn::ParameterShape& shape : parameter_shapes(description)) {
    if (shape.shape.size() == 4) expected_weights += shape.elements();
  }
  CHECK(weights * times == expected_weights);
}

}  // namespace

TEST_CASE("the convolutions of a network are all that it multiplies, and hold all its weights") {
  for (const nn::NetworkKind kind : {nn::NetworkKind::kDuOr, nn::NetworkKind::kSimpleDu}) {
    for (const std::vector<int>& channels :
         {std::vector<int>{24, 32}, std::vector<int>{8, 16, 24}}) {
      nn::NetworkDescription description = description_of(kind);
      description.u_shaped.channels = channels;
      check_convolutions(description, description.layers);
    }
  }
  nn::NetworkDescription mix = description_of(nn::NetworkKind::kDuMix);
  mix.layers = 1;
  check_convolutions(mix, 1);
  mix.layers = 2;
  mix.two_modes.layers = {{16, 24, 2}, {8, 16, 0}};
  check_convolutions(mix, 1);
}

}  // namespace hqslam::tools

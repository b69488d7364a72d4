#include "network_steps.h"

#include <doctest/doctest.h>

#include "hqslam/nn/hqs/unrolled_network.h"

namespace hqslam::tools {

TEST_CASE("the convolutions of a network are all that it multiplies, and hold all its weights") {
  for (const nn::NetworkKind kind : {nn::NetworkKind::kDuOr, nn::NetworkKind::kSimpleDu}) {
    for (const std::vector<int>& channels :
         {std::vector<int>{24, 32}, std::vector<int>{8, 16, 24}}) {
      nn::NetworkDescription description;
      description.kind = kind;
      description.sensor = sensor_preset("os1-64");
      description.measured_rows = selection_for(64, 16);
      description.u_shaped.channels = channels;
      description.plain.features = 8;
      const nn::UnrolledNetwork network(description, 1024, nn::InstructionSet::kPortable, 1);
      std::int64_t multiply_adds = 0;
      std::int64_t weights = 0;
      for (const NetworkConvolution& layer : convolutions_of(description)) {
        multiply_adds += layer.multiply_adds();
        weights += layer.shape.weights();
      }
      CHECK(multiply_adds * description.layers == network.multiply_adds());
      std::int64_t expected_weights = 0;
      for (const nn::ParameterShape& shape : parameter_shapes(description)) {
        if (shape.shape.size() == 4) {
          expected_weights += shape.elements();
        }
      }
      CHECK(weights * description.layers == expected_weights);
    }
  }
}

}  // namespace hqslam::tools

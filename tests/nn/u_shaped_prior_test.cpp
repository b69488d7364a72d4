#include "hqs/u_shaped_prior.h"

#include "hqslam/nn/network_description.h"
#include "testing.h"

namespace hqslam::nn {
namespace {

const UShapedPriorShape kSmall{
    .tile = {2, 4}, .channels = {5, 7, 6}, .memory = 3, .negative_slope = 0.1F};

}  // namespace

TEST_CASE("the U-shaped denoiser's arrays have the names and shapes of its description") {
  const PriorDescription prior = u_shaped_prior(kSmall);
  const Engine engine{InstructionSet::kPortable, 1};
  const std::vector<ParameterShape> shapes =
      prior.make(prior.graph(8, 32, engine), {}, 32, engine)->parameter_shapes();
  const std::vector<std::pair<std::string, std::vector<std::int64_t>>> expected{
      {"encoder.0.weight", {5, 11, 3, 3}}, {"encoder.0.bias", {5}},
      {"encoder.1.weight", {7, 5, 3, 3}},  {"encoder.1.bias", {7}},
      {"encoder.2.weight", {6, 7, 3, 3}},  {"encoder.2.bias", {6}},
      {"bottleneck.weight", {6, 6, 3, 3}}, {"bottleneck.bias", {6}},
      {"decoder.1.weight", {6, 7, 2, 2}},  {"decoder.1.bias", {7}},
      {"decoder.0.weight", {7, 5, 2, 2}},  {"decoder.0.bias", {5}},
      {"head.weight", {43, 5, 1, 1}},      {"head.bias", {43}}};
  REQUIRE(shapes.size() == expected.size());
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    CHECK(shapes[i].name == expected[i].first);
    CHECK(shapes[i].shape == expected[i].second);
  }
}

}  // namespace hqslam::nn

#include "hqs/plain_prior.h"

#include "golden.h"
#include "hqs/prior_backward.h"

namespace hqslam::nn {
namespace {

std::unique_ptr<Prior> made_prior(const PlainPriorShape& shape, int rows, int columns) {
  const PriorDescription prior = plain_prior(shape);
  const Engine engine{chosen_instruction_set(), 1};
  return prior.make(prior.graph(rows, columns, engine), {}, columns, engine);
}

}  // namespace

TEST_CASE("Simple DU's denoiser has the 111,744 weights of the authors' code and no bias") {
  const auto prior = made_prior({}, 1, 1);
  std::int64_t sum = 0;
  for (const ParameterShape& shape : prior->parameter_shapes()) {
    CHECK(shape.name.ends_with(".weight"));
    sum += shape.elements();
  }
  CHECK(sum == 111744);
  CHECK(prior->multiply_adds() == 111744);
}

TEST_CASE("with dropout the gradient is that of the activations that were left") {
  const auto prior = made_prior({.features = 12, .convolutions = 3, .dropout = 0.25F}, 8, 40);
  std::vector<float> parameters = prior->graph().initial_parameters(7);
  PriorState state = prior->make_state();
  fill_random(1, state.input());
  const auto sum_of_z = [&] {
    prior->set_parameters(parameters);
    prior->forward({}, state, {.dropout_seed = 5});
    const std::vector<float> z = values_of(state.z);
    return std::accumulate(z.begin(), z.end(), 0.0);
  };
  sum_of_z();
  PriorState gradient = prior->make_state();
  for (int y = 0; y < 8; ++y) std::fill_n(gradient.z.row(0, y), 40, 1.0F);
  std::vector<float> d_parameters(parameters.size());
  const auto backward = backward_of(*prior);
  backward->take_parameters(parameters);
  backward->backward({}, state, gradient, d_parameters);
  // The first layer, where a ReLU may change sides.
  float largest = 0.0F;
  for (int i = 0; i < 108; ++i) largest = std::max(largest, std::fabs(d_parameters[i]));
  int close = 0;
  for (std::size_t i = 0; i < 108; i += 9) {
    close += std::fabs(slope_of(sum_of_z, 1e-3F, parameters[i]) - d_parameters[i]) < 0.02 * largest;
  }
  CHECK(close >= 10);
}

}  // namespace hqslam::nn

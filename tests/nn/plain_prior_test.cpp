#include "hqs/plain_prior.h"

#include "golden.h"
#include "hqs/prior_backward.h"
#include "random_values.h"
#include "testing.h"

namespace hqslam::nn {
namespace {

struct Run {
  std::unique_ptr<Prior> prior;
  std::vector<float> parameters;
  PriorState state;
  Candidates candidates;
};

std::unique_ptr<Prior> made_prior(const PlainPriorShape& shape, int rows, int columns) {
  const PriorDescription prior = plain_prior(shape);
  const Engine engine{chosen_instruction_set(), 1};
  return prior.make(prior.graph(rows, columns, engine), {}, columns, engine);
}

Run run(const PlainPriorShape& shape, std::optional<std::uint64_t> dropout_seed) {
  Run r;
  r.prior = made_prior(shape, 8, 40);
  r.parameters = r.prior->graph().initial_parameters(7);
  r.prior->set_parameters(r.parameters);
  r.state = r.prior->make_state();
  fill_random(1, r.state.input());
  r.prior->forward(r.candidates, r.state, {.dropout_seed = dropout_seed});
  return r;
}

double zero_share(const Tensor& tensor) {
  const std::vector<float> values = values_of(tensor);
  return static_cast<double>(std::ranges::count(values, 0.0F)) / static_cast<double>(values.size());
}

constexpr PlainPriorShape kDropout{.features = 12, .convolutions = 3, .dropout = 0.25F};

double sum_of(const Tensor& z) {
  double sum = 0.0;
  for (const float value : values_of(z)) sum += value;
  return sum;
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

TEST_CASE("without a seed nothing is dropped; with one, the share that was asked for") {
  const Run plain = run(kDropout, std::nullopt);
  const Run dropped = run(kDropout, 5);
  const double expected =
      zero_share(plain.state.values[1]) + 0.25 * (1.0 - zero_share(plain.state.values[1]));
  CHECK(zero_share(dropped.state.values[1]) == doctest::Approx(expected).epsilon(0.03));
  for (int x = 0; x < 40; ++x) {  // what is left is scaled so that the mean stays
    const float value = dropped.state.values[1].at(3, 4, x);
    if (value != 0.0F) {
      CHECK(value == doctest::Approx(plain.state.values[1].at(3, 4, x) / 0.75));
    }
  }
}

TEST_CASE("with dropout the gradient is that of the activations that were left") {
  Run r = run(kDropout, 5);
  const std::vector<float>& parameters = r.parameters;
  PriorState gradient = r.prior->make_state();
  for (int y = 0; y < 8; ++y) std::fill_n(gradient.z.row(0, y), 40, 1.0F);
  std::vector<float> d_parameters(parameters.size());
  const auto backward = backward_of(*r.prior);
  backward->take_parameters(parameters);
  backward->backward(r.candidates, r.state, gradient, d_parameters);
  const double before = sum_of(r.state.z);
  const auto change = [&](std::size_t i, float by) {
    std::vector<float> changed = parameters;
    changed[i] += by;
    r.prior->set_parameters(changed);
    r.prior->forward(r.candidates, r.state, {.dropout_seed = 5});
    return sum_of(r.state.z) - before;
  };
  // The first layer, where a ReLU may change sides.
  float largest = 0.0F;
  for (int i = 0; i < 108; ++i) largest = std::max(largest, std::fabs(d_parameters[i]));
  int close = 0;
  for (std::size_t i = 0; i < 108; i += 9) {
    close += std::fabs(change(i, 1e-3F) / 1e-3 - d_parameters[i]) < 0.02 * largest;
  }
  CHECK(close >= 10);
}

}  // namespace hqslam::nn

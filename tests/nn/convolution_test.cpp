#include "convolution_reference.h"
#include "golden.h"
#include "graph/layer_backward.h"

namespace hqslam::nn {
namespace {

struct Case {
  ConvolutionShape shape;
  int rows;
  int columns;
  ColumnPadding padding;
};

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const ColumnPadding padding : {ColumnPadding::kCircular, ColumnPadding::kZero}) {
    for (const int columns : {16, 48, 112, 256, 20, 6}) {
      all.push_back({{5, 11, 3, 3, 1, 1, 1}, 5, columns, padding});
      all.push_back({{3, 8, 1, 1, 1, 0, 0}, 4, columns, padding});
      all.push_back({{4, 9, 3, 3, 2, 1, 1}, 6, columns, padding});
      all.push_back({{2, 17, 2, 2, 2, 0, 0}, 4, columns, padding});
      all.push_back({{3, 5, 4, 4, 2, 1, 1}, 8, columns, padding});
      all.push_back({{2, 3, 3, 5, 1, 1, 2}, 3, columns, padding});
      all.push_back({{3, 9, 3, 3, 2, 1, 1, 1}, 6, columns, padding});  // strides 2 x 1
    }
    all.push_back({{17, 18, 3, 3, 1, 1, 1}, 5, 48, padding});   // computed by WinogradConvolution
    all.push_back({{1, 2, 5, 3, 3, 2, 0, 1}, 9, 12, padding});  // strides 3 x 1
    all.push_back({{1, 9, 1, 8, 1, 0, 3, 2}, 3, 64, padding});  // strides 1 x 2
    all.push_back({{2, 3, 3, 4, 1, 1, 2}, 3, 20, padding});     // zero: one column more than before
    all.push_back({{2, 3, 3, 5, 2, 1, 2}, 4, 15, padding});
    all.push_back({{2, 3, 3, 2, 2, 1, 0}, 4, 17, padding});  // zero: the last column has no tap
  }
  return all;
}

void check_close(const std::vector<float>& actual, const std::vector<float>& expected) {
  for (std::size_t i = 0; i < expected.size(); ++i) {
    REQUIRE(actual[i] == doctest::Approx(expected[i]).epsilon(1e-5).scale(10));
  }
}

/// Everything that one layer computes.
struct Outcome {
  Tensor output;
  Tensor d_input;
  std::vector<float> d_parameters;  ///< of the weights, then of the biases
};

struct ConvolutionProblem {
  ConvolutionShape shape;
  Tensor input;
  Tensor output;  ///< only its shape
  Tensor d_output;
  std::vector<float> parameters;

  ConvolutionLayer layer(InstructionSet instruction_set = chosen_instruction_set()) const {
    ConvolutionLayer layer({.channels = shape.output_channels,
                            .kernel = {shape.kernel_rows, shape.kernel_columns},
                            .stride = {shape.stride, shape.column_stride()},
                            .padding = {shape.padding_rows, shape.padding_columns},
                            .transposed = shape.transposed},
                           input, output, {instruction_set, 1});
    if (!parameters.empty()) layer.set_parameters(parameters);
    return layer;
  }
  Outcome empty_outcome() const {
    Outcome outcome{output, input, std::vector<float>(parameters.size(), -1.0F)};
    std::fill_n(outcome.d_parameters.begin(), shape.weights(), 0.25F);
    return outcome;
  }
};

ConvolutionProblem problem(const Case& c, bool transposed) {
  const ConvolutionShape& s = c.shape;
  const int columns =
      c.padding == ColumnPadding::kCircular
          ? c.columns / s.column_stride()
          : convolved_size(c.columns, s.kernel_columns, s.column_stride(), s.padding_columns);
  const int rows = convolved_size(c.rows, s.kernel_rows, s.stride, s.padding_rows);
  Tensor narrow(s.output_channels, rows, columns, c.padding, 4);
  Tensor wide(c.shape.input_channels, c.rows, c.columns, c.padding, 4);
  ConvolutionProblem p{c.shape, wide, narrow, narrow, {}};
  if (transposed) {
    p = {c.shape, narrow, wide, wide, {}};
    std::swap(p.shape.input_channels, p.shape.output_channels);
    p.shape.transposed = true;
  }
  fill_random(1, p.input);
  fill_random(2, p.d_output);
  p.parameters = random_values(3, p.shape.weights());
  const std::vector<float> bias = random_values(4, p.shape.output_channels);
  p.parameters.insert(p.parameters.end(), bias.begin(), bias.end());
  return p;
}

Outcome outcome_of(ConvolutionLayer& layer, const ConvolutionProblem& p,
                   InstructionSet instruction_set = chosen_instruction_set()) {
  Outcome outcome = p.empty_outcome();
  layer.forward({.input = &p.input, .output = &outcome.output});
  const BackwardPass back{.input = &p.input, .d_output = &p.d_output, .d_input = &outcome.d_input};
  ConvolutionBackward backward(layer, {instruction_set, 1});
  backward.set_parameters(p.parameters);
  backward.backward({&back, 1}, outcome.d_parameters);
  return outcome;
}

Outcome with_reference(const ConvolutionProblem& p) {
  Outcome o = p.empty_outcome();
  const auto weights = static_cast<std::size_t>(p.shape.weights());
  const std::span<const float> parameters = p.parameters;
  const std::span<float> d_parameters = o.d_parameters;
  conv2d_reference(p.shape, parameters.first(weights), parameters.subspan(weights), p.input,
                   o.output);
  conv2d_backward_reference(p.shape, parameters.first(weights), p.input, p.d_output, o.d_input,
                            d_parameters.first(weights), d_parameters.subspan(weights));
  return o;
}

void check_against_reference(bool transposed) {
  for (const Case& c : cases()) {
    if (c.padding == ColumnPadding::kCircular && c.columns % c.shape.column_stride() != 0) continue;
    const ConvolutionProblem p = problem(c, transposed);
    const Outcome expected = with_reference(p);
    for (const InstructionSet instruction_set : available_instruction_sets()) {
      CAPTURE(name(instruction_set));
      CAPTURE(c.columns);
      CAPTURE(c.shape.kernel_rows);
      CAPTURE(c.shape.stride);
      ConvolutionLayer layer = p.layer(instruction_set);
      const Outcome actual = outcome_of(layer, p, instruction_set);
      check_close(actual.output, expected.output, 2);
      check_close(actual.d_input, expected.d_input, 2);
      check_close(actual.d_parameters, expected.d_parameters);
      Tensor ended = p.output;  // with a skip, here d_output
      p.layer(instruction_set).forward({&p.input, &p.d_output, &ended});
      for_each_value(ended, 0, [&](int channel, int y, int x) {
        const float sum = actual.output.at(channel, y, x) + p.d_output.at(channel, y, x);
        REQUIRE(ended.at(channel, y, x) == doctest::Approx(sum).epsilon(1e-5).scale(1));
      });
    }
  }
}

}  // namespace

TEST_CASE("convolutions, also transposed, their gradients and skips equal the reference") {
  check_against_reference(false);
  check_against_reference(true);
}

TEST_CASE("new parameters count forward and backward, whichever kernel computes the convolution") {
  for (const int channels : {5, 16}) {
    ConvolutionProblem p =
        problem({{channels, channels, 3, 3, 1, 1, 1}, 4, 32, ColumnPadding::kZero}, false);
    ConvolutionLayer layer = p.layer();
    for (const std::uint32_t seed : {11U, 12U}) {
      p.parameters = random_values(seed, std::ssize(p.parameters));
      layer.set_parameters(p.parameters);
      const Outcome outcome = outcome_of(layer, p);
      const Outcome expected = with_reference(p);
      check_close(outcome.output, expected.output, 2);
      check_close(outcome.d_input, expected.d_input, 2);
    }
  }
}

TEST_CASE("shapes that do not fit are refused") {
  const Tensor input(3, 8, 32, ColumnPadding::kCircular);
  const Tensor half(4, 4, 16, ColumnPadding::kCircular);
  const auto make = [](const ConvolutionShape& shape, const Tensor& narrow, const Tensor& wide) {
    kernels::StridedConvolution(shape, narrow, wide, chosen_instruction_set());
  };
  CHECK_NOTHROW(make({3, 4, 3, 3, 2, 1, 1}, half, input));
  CHECK_THROWS_AS(make({2, 4, 3, 3, 2, 1, 1}, half, input), Error);
  CHECK_THROWS_AS(make({3, 4, 3, 3, 1, 1, 1}, half, input), Error);
  CHECK_THROWS_AS(make({3, 4, 7, 3, 2, 3, 1}, half, input), Error);
  CHECK_THROWS_AS(make({3, 4, 3, 3, 0, 1, 1}, half, input), Error);
  // With zeros beyond the edge and these paddings a tap would find zeros inside the image,
  const Tensor wide(1, 8, 16, ColumnPadding::kZero);
  const auto narrow = [](int rows, int columns) {
    return Tensor(1, rows, columns, ColumnPadding::kZero, 4);
  };
  CHECK_THROWS_AS(make({1, 1, 3, 3, 2, 1, 0}, narrow(4, 7), wide), Error);
  CHECK_THROWS_AS(make({1, 1, 3, 5, 2, 1, 0}, narrow(4, 6), wide), Error);
  CHECK_THROWS_AS(
      (ConvolutionProblem{{1, 1, 3, 3, 2, 1, 0, 2, true}, narrow(4, 7), wide, wide, {}}.layer()),
      Error);
  // or a whole vector would end beyond the border.
  CHECK_THROWS_AS(make({1, 1, 3, 4, 1, 1, 2}, narrow(8, 17), wide), Error);
  CHECK_THROWS_AS(make({1, 1, 3, 2, 2, 1, 10}, narrow(4, 18), wide), Error);
  // Kernels have column strides 1 and 2 alone.
  CHECK(refused_with(
      [&] {
        make({3, 4, 3, 3, 1, 1, 1, 4}, half, input);
      },
      "stride_columns is 4", "1 to 2"));
  ConvolutionLayer layer = ConvolutionProblem{{3, 4, 3, 3, 2, 1, 1}, input, half, half, {}}.layer();
  CHECK_THROWS_AS(layer.set_parameters(std::vector<float>(5)), Error);
  CHECK_THROWS_AS(layer.set_parameters(std::vector<float>(108 + 3)), Error);
}

}  // namespace hqslam::nn

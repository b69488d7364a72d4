#include <doctest/doctest.h>

#include <vector>

#include "conv2d.h"
#include "hqslam/core/error.h"
#include "random_values.h"

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
    all.push_back({{17, 18, 3, 3, 1, 1, 1}, 5, 48, padding});  // Winograd's way
    all.push_back({{1, 2, 5, 3, 3, 2, 0}, 9, 12, padding});
    all.push_back({{1, 9, 1, 8, 1, 0, 2, 4}, 3, 64, padding});  // strides 1 x 4
    all.push_back({{2, 3, 3, 4, 1, 1, 2}, 3, 20, padding});     // zero: one column more than before
    all.push_back({{2, 3, 3, 5, 2, 1, 2}, 4, 15, padding});
    all.push_back({{2, 3, 3, 2, 2, 1, 0}, 4, 17, padding});  // zero: the last column has no tap
  }
  return all;
}

Tensor narrow_tensor(const ConvolutionShape& s, const Case& c, int channels) {
  const int columns =
      c.padding == ColumnPadding::kCircular
          ? c.columns / s.column_stride()
          : convolved_size(c.columns, s.kernel_columns, s.column_stride(), s.padding_columns);
  return {channels, convolved_size(c.rows, s.kernel_rows, s.stride, s.padding_rows), columns,
          c.padding, 4};
}

void check_close(const Tensor& actual, const Tensor& expected) {
  for (int c = 0; c < expected.channels(); ++c) {
    for (int y = 0; y < expected.rows(); ++y) {
      for (int x = -2; x < expected.columns() + 2; ++x) {  // the border too
        REQUIRE(actual.at(c, y, x) == doctest::Approx(expected.at(c, y, x)).epsilon(1e-5).scale(1));
      }
    }
  }
}

void check_close(const std::vector<float>& actual, const std::vector<float>& expected) {
  for (std::size_t i = 0; i < expected.size(); ++i) {
    REQUIRE(actual[i] == doctest::Approx(expected[i]).epsilon(1e-5).scale(10));
  }
}

/// Everything that one layer computes, with one instruction set and number of threads.
struct Outcome {
  Tensor output;
  Tensor d_input;
  std::vector<float> d_weight;
  std::vector<float> d_bias;
};

struct Problem {
  ConvolutionShape shape;
  Tensor input;
  Tensor output;  ///< only its shape
  Tensor d_output;
  std::vector<float> weight;
  std::vector<float> bias;

  Outcome empty_outcome() const {
    return {output, input, std::vector<float>(weight.size(), 0.25F),
            std::vector<float>(bias.size(), -1.0F)};
  }
};

Problem problem(const Case& c, bool transposed) {
  Tensor narrow = narrow_tensor(c.shape, c, c.shape.output_channels);
  Tensor wide(c.shape.input_channels, c.rows, c.columns, c.padding, 4);
  Problem p{c.shape, wide, narrow, narrow, {}, {}};
  if (transposed) {
    p = {c.shape, narrow, wide, wide, {}, {}};
    std::swap(p.shape.input_channels, p.shape.output_channels);
    p.shape.transposed = true;
  }
  fill_random(1, p.input);
  fill_random(2, p.d_output);
  p.weight = random_values(3, p.shape.weights());
  p.bias = random_values(4, p.shape.output_channels);
  return p;
}

Outcome with_layer(const Problem& p, InstructionSet instruction_set, int threads) {
  Outcome outcome = p.empty_outcome();
  Conv2d layer(p.shape, p.input, p.output, instruction_set, threads);
  layer.set_parameters(p.weight, p.bias);
#pragma omp parallel num_threads(threads)
  {
    layer.forward(p.input, {}, outcome.output);
    layer.backward_input(p.d_output, {}, outcome.d_input);
  }
  layer.backward_parameters(p.input, p.d_output, outcome.d_weight, outcome.d_bias);
  return outcome;
}

Outcome with_reference(const Problem& p) {
  Outcome o = p.empty_outcome();
  conv2d_reference(p.shape, p.weight, p.bias, p.input, o.output);
  conv2d_backward_reference(p.shape, p.weight, p.input, p.d_output, o.d_input, o.d_weight,
                            o.d_bias);
  return o;
}

void check_against_reference(bool transposed) {
  for (const Case& c : cases()) {
    const bool uneven =
        c.padding == ColumnPadding::kCircular && c.columns % c.shape.column_stride() != 0;
    if (uneven) continue;
    const Problem p = problem(c, transposed);
    const Outcome expected = with_reference(p);
    for (const InstructionSet instruction_set : available_instruction_sets()) {
      CAPTURE(name(instruction_set));
      CAPTURE(c.columns);
      CAPTURE(c.shape.kernel_rows);
      CAPTURE(c.shape.stride);
      const Outcome actual = with_layer(p, instruction_set, 1);
      check_close(actual.output, expected.output);
      check_close(actual.d_input, expected.d_input);
      check_close(actual.d_weight, expected.d_weight);
      check_close(actual.d_bias, expected.d_bias);
    }
  }
}

}  // namespace

TEST_CASE("conv2d and its gradients equal the reference with every instruction set") {
  check_against_reference(false);
}

TEST_CASE("conv_transpose2d and its gradients equal the reference with every instruction set") {
  check_against_reference(true);
}

TEST_CASE("conv2d of a 1-2-3 row with kernel 1 10 100 is what a hand computes, going round") {
  Tensor input(1, 1, 3, ColumnPadding::kCircular);
  Tensor output = input;
  for (int x = 0; x < 3; ++x) input.at(0, 0, x) = static_cast<float>(x + 1);
  input.fill_borders();
  Conv2d layer({1, 1, 1, 3, 1, 0, 1}, input, output, chosen_instruction_set());
  layer.set_parameters(std::vector<float>{1, 10, 100}, std::vector<float>{1000});
  layer.forward(input, {}, output);
  CHECK(output.at(0, 0, 0) == 1000 + 3 * 1 + 1 * 10 + 2 * 100);
  CHECK(output.at(0, 0, 1) == 1000 + 1 * 1 + 2 * 10 + 3 * 100);
  CHECK(output.at(0, 0, 2) == 1000 + 2 * 1 + 3 * 10 + 1 * 100);
}

TEST_CASE("one and two threads give the same bits") {
  const Case c{{5, 11, 3, 3, 2, 1, 1}, 16, 256, ColumnPadding::kCircular};
  const Problem conv = problem(c, false);
  const Problem transposed = problem(c, true);
  for (const InstructionSet instruction_set : available_instruction_sets()) {
    CHECK(same_bits(with_layer(conv, instruction_set, 1).output,
                    with_layer(conv, instruction_set, 2).output));
    CHECK(same_bits(with_layer(transposed, instruction_set, 1).output,
                    with_layer(transposed, instruction_set, 2).output));
  }
}

TEST_CASE("new parameters count forward and backward, whichever way the convolution goes") {
  for (const int channels : {5, 16}) {
    Problem p = problem({{channels, channels, 3, 3, 1, 1, 1}, 4, 32, ColumnPadding::kZero}, false);
    Outcome outcome = p.empty_outcome();
    Conv2d layer(p.shape, p.input, p.output, chosen_instruction_set());
    for (const std::uint32_t seed : {11U, 12U}) {
      p.weight = random_values(seed, p.shape.weights());
      layer.set_parameters(p.weight, p.bias);
      layer.forward(p.input, {}, outcome.output);
      layer.backward_input(p.d_output, {}, outcome.d_input);
      const Outcome expected = with_reference(p);
      check_close(outcome.output, expected.output);
      check_close(outcome.d_input, expected.d_input);
    }
  }
}

TEST_CASE("a single row is refused where the kernel has more") {
  const Problem p = problem({{3, 8, 3, 3, 1, 1, 1}, 4, 32, ColumnPadding::kCircular}, false);
  Conv2d layer(p.shape, p.input, p.output, chosen_instruction_set());
  layer.set_parameters(p.weight, p.bias);
  std::vector<float> row(static_cast<std::size_t>(8) * 32);
  CHECK_THROWS_AS(layer.forward_row(p.input, 0, row.data(), 32), Error);
}

TEST_CASE("skip and activation are applied to the sum") {
  const Problem p = problem({{3, 8, 3, 3, 1, 1, 1}, 4, 32, ColumnPadding::kCircular}, false);
  Tensor skip = p.output;
  fill_random(9, skip);
  Tensor plain = p.output;
  Tensor ended = p.output;
  Conv2d layer(p.shape, p.input, p.output, chosen_instruction_set());
  layer.set_parameters(p.weight, p.bias);
  layer.forward(p.input, {}, plain);
  layer.forward(p.input, {0.1F, &skip}, ended);
  for (int x = 0; x < 32; ++x) {
    const float sum = plain.at(7, 3, x) + skip.at(7, 3, x);
    CHECK(ended.at(7, 3, x) == doctest::Approx(sum > 0 ? sum : 0.1F * sum));
  }
}

TEST_CASE("shapes that do not fit are refused") {
  const Tensor input(3, 8, 32, ColumnPadding::kCircular);
  const Tensor half(4, 4, 16, ColumnPadding::kCircular);
  const InstructionSet any = chosen_instruction_set();
  CHECK_NOTHROW(Conv2d({3, 4, 3, 3, 2, 1, 1}, input, half, any));
  CHECK_THROWS_AS(Conv2d({2, 4, 3, 3, 2, 1, 1}, input, half, any), Error);
  CHECK_THROWS_AS(Conv2d({3, 4, 3, 3, 1, 1, 1}, input, half, any), Error);
  CHECK_THROWS_AS(Conv2d({3, 4, 7, 3, 2, 3, 1}, input, half, any), Error);
  CHECK_THROWS_AS(Conv2d({3, 4, 3, 3, 0, 1, 1}, input, half, any), Error);
  // With zeros beyond the edge and these paddings a tap would find zeros inside the image,
  const Tensor wide(1, 8, 16, ColumnPadding::kZero);
  const auto narrow = [](int rows, int columns) {
    return Tensor(1, rows, columns, ColumnPadding::kZero, 4);
  };
  CHECK_THROWS_AS(Conv2d({1, 1, 3, 3, 2, 1, 0}, wide, narrow(4, 7), any), Error);
  CHECK_THROWS_AS(Conv2d({1, 1, 3, 5, 3, 1, 0}, wide, narrow(3, 4), any), Error);
  CHECK_THROWS_AS(Conv2d({1, 1, 3, 3, 2, 1, 0, 2, true}, narrow(4, 7), wide, any), Error);
  // or a whole vector would end beyond the border.
  CHECK_THROWS_AS(Conv2d({1, 1, 3, 4, 1, 1, 2}, wide, narrow(8, 17), any), Error);
  Conv2d layer({3, 4, 3, 3, 2, 1, 1}, input, half, any);
  CHECK_THROWS_AS(layer.set_parameters(std::vector<float>(5), {}), Error);
  CHECK_THROWS_AS(layer.set_parameters(std::vector<float>(108), std::vector<float>(3)), Error);
}

}  // namespace hqslam::nn

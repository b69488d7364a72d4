#include "kernels/winograd_convolution.h"

#include "convolution_reference.h"
#include "random_values.h"

namespace hqslam::nn::kernels {
namespace {

struct WinogradProblem {
  ConvolutionShape shape;
  Tensor input;
  Tensor output;  ///< only its shape
  std::vector<float> weight;
  std::vector<float> bias;
};

WinogradProblem random_winograd_problem(int inputs, int outputs, int rows, int columns,
                                        ColumnPadding padding) {
  WinogradProblem p{{inputs, outputs, 3, 3, 1, 1, 1},
                    Tensor(inputs, rows, columns, padding),
                    Tensor(outputs, rows, columns, padding),
                    {},
                    {}};
  fill_random(1, p.input);
  p.weight = random_values(2, p.shape.weights());
  p.bias = random_values(3, outputs);
  return p;
}

Tensor convolved(const WinogradProblem& p, InstructionSet instruction_set,
                 const LayerEnd& end = {}) {
  WinogradConvolution convolution(p.shape, p.input, instruction_set, 1);
  convolution.set_weights(p.weight);
  Tensor output = p.output;
  convolution.forward(p.input, p.bias.data(), end, output);
  return output;
}

Tensor convolved_by_reference(const WinogradProblem& p) {
  Tensor output = p.output;
  conv2d_reference(p.shape, p.weight, p.bias, p.input, output);
  return output;
}

}  // namespace

TEST_CASE("Winograd's convolution equals the reference at every size, on every instruction set") {
  for (const ColumnPadding padding : {ColumnPadding::kCircular, ColumnPadding::kZero}) {
    for (const int rows : {1, 2, 3, 8, 13}) {
      for (const int columns : {1, 6, 16, 31, 32, 33, 48, 64, 100, 225, 288}) {
        const WinogradProblem p = random_winograd_problem(5, 9, rows, columns, padding);
        const Tensor expected = convolved_by_reference(p);
        for (const InstructionSet instruction_set : available_instruction_sets()) {
          CAPTURE(name(instruction_set));
          CAPTURE(rows);
          CAPTURE(columns);
          check_close(convolved(p, instruction_set), expected, Tensor::kBorderColumns);
        }
      }
    }
  }
}

TEST_CASE("Winograd's gradients equal the reference at every size, on every instruction set") {
  for (const ColumnPadding padding : {ColumnPadding::kCircular, ColumnPadding::kZero}) {
    for (const int rows : {1, 2, 3, 13}) {
      for (const int columns : {1, 16, 31, 33, 48, 225, 288}) {
        // More channels: several panels.
        const WinogradProblem p =
            random_winograd_problem(columns == 288 ? 24 : 5, 9, rows, columns, padding);
        Tensor d_output = p.output;
        fill_random(6, d_output);
        Tensor d_input = p.input;
        std::vector<float> d_weight(p.weight.size(), 0.25F);
        std::vector<float> d_bias(p.bias.size());
        conv2d_backward_reference(p.shape, p.weight, p.input, d_output, d_input, d_weight, d_bias);
        for (const InstructionSet instruction_set : available_instruction_sets()) {
          CAPTURE(name(instruction_set));
          CAPTURE(rows);
          CAPTURE(columns);
          const WinogradConvolution forward(p.shape, p.input, instruction_set, 1);
          std::vector<float> gradient(p.weight.size(), 0.25F);
          forward.add_weight_gradient(p.input, d_output, gradient);
          for (std::size_t i = 0; i < gradient.size(); ++i) {
            REQUIRE(gradient[i] == doctest::Approx(d_weight[i]).epsilon(1e-5).scale(20));
          }
          ConvolutionShape swapped = p.shape;
          std::swap(swapped.input_channels, swapped.output_channels);
          WinogradConvolution adjoint(swapped, d_output, instruction_set, 1);
          adjoint.set_weights(p.weight, true);
          Tensor actual = p.input;
          adjoint.forward(d_output, nullptr, {}, actual);
          check_close(actual, d_input, 0);
        }
      }
    }
  }
}

// The direct kernels add 576 products one after the other and round up to 2.0e-7 of that sum; 64 at
// each of 16 places round up to 0.9e-7.
TEST_CASE("Winograd's convolution rounds less than 2e-7 of the sum of what is added") {
  const WinogradProblem p = random_winograd_problem(64, 16, 8, 64, ColumnPadding::kCircular);
  WinogradProblem magnitudes = p;
  for (float& weight : magnitudes.weight) weight = std::fabs(weight);
  for (float& bias : magnitudes.bias) bias = std::fabs(bias);
  for_each_value(p.input, Tensor::kBorderColumns, [&](int c, int y, int x) {
    magnitudes.input.at(c, y, x) = std::fabs(p.input.at(c, y, x));
  });
  const Tensor scale = convolved_by_reference(magnitudes);
  for (const InstructionSet instruction_set : available_instruction_sets()) {
    const Tensor actual = convolved(p, instruction_set);
    double largest = 0.0;
    for_each_value(actual, 0, [&](int o, int y, int x) {
      double exact = p.bias[o];
      for (int i = 0; i < 64; ++i) {
        for (int tap = 0; tap < 9; ++tap) {
          exact += static_cast<double>(p.weight[(o * 64 + i) * 9 + tap]) *
                   p.input.at(i, y + tap / 3 - 1, x + tap % 3 - 1);
        }
      }
      largest = std::max(largest, std::fabs(actual.at(o, y, x) - exact) / scale.at(o, y, x));
    });
    CAPTURE(name(instruction_set));
    CHECK(largest < 2e-7);
  }
}

TEST_CASE("Winograd's convolution ends as the others do: skip, then activation or its gradient") {
  const WinogradProblem p = random_winograd_problem(16, 16, 5, 70, ColumnPadding::kCircular);
  const Tensor sum = convolved_by_reference(p);
  Tensor skip = p.output;
  Tensor activated = p.output;
  fill_random(4, skip);
  fill_random(5, activated);
  for (const InstructionSet instruction_set : available_instruction_sets()) {
    CAPTURE(name(instruction_set));
    const Tensor ended = convolved(p, instruction_set, {0.1F, &skip});
    const Tensor gradient = convolved(p, instruction_set, {0.1F, &skip, &activated});
    for_each_value(sum, Tensor::kBorderColumns, [&](int c, int y, int x) {
      const float value = sum.at(c, y, x) + skip.at(c, y, x);
      const float slope = activated.at(c, y, x) > 0.0F ? 1.0F : 0.1F;
      REQUIRE(ended.at(c, y, x) ==
              doctest::Approx(std::max(value, 0.1F * value)).epsilon(1e-5).scale(1));
      REQUIRE(gradient.at(c, y, x) == doctest::Approx(slope * value).epsilon(1e-5).scale(1));
    });
  }
}

}  // namespace hqslam::nn::kernels

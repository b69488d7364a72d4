#include <vector>

#include "conv2d.h"
#include "golden.h"
#include "hqslam/nn/instruction_set.h"

namespace hqslam::nn {
namespace {

constexpr double kTolerance = 1e-5;

struct Layer {
  ConvolutionShape shape;
  Tensor input;
  Tensor d_output;
  std::vector<float> weight;
  std::vector<float> bias;
};

Layer layer(const Golden& golden, const std::string& name) {
  const std::vector<std::int64_t> stored = int64_values(golden.array(name + ".shape"), name);
  std::vector<int> s(stored.begin(), stored.end());
  const ColumnPadding padding = s.at(11) != 0 ? ColumnPadding::kCircular : ColumnPadding::kZero;
  Layer layer;
  layer.shape = {s[0], s[1], s[2], s[3], s[4], s[5], s[6]};
  layer.input = tensor_of(golden.values(name + ".input"), s[0], s[7], s[8], padding, 2);
  layer.d_output = tensor_of(golden.values(name + ".d_output"), s[1], s[9], s[10], padding, 2);
  layer.weight = golden.values(name + ".weight");
  if (golden.has(name + ".bias")) layer.bias = golden.values(name + ".bias");
  return layer;
}

void check_all(const std::string& kind, bool transposed, int cases) {
  const Golden golden("convolutions");
  for (int i = 0; i < cases; ++i) {
    const std::string name = kind + "." + std::to_string(i);
    CAPTURE(name);
    Layer l = layer(golden, name);
    l.shape.transposed = transposed;
    for (const InstructionSet instruction_set : available_instruction_sets()) {
      CAPTURE(nn::name(instruction_set));
      Tensor output = l.d_output;
      Tensor d_input = l.input;
      std::vector<float> d_weight(l.weight.size());
      std::vector<float> d_bias(l.bias.size());
      Conv2d convolution(l.shape, l.input, output, instruction_set);
      convolution.set_parameters(l.weight, l.bias);
      convolution.forward(l.input, {}, output);
      convolution.backward_input(l.d_output, {}, d_input);
      convolution.backward_parameters(l.input, l.d_output, d_weight, d_bias);
      CHECK(relative_error(output, golden.values(name + ".output")) < kTolerance);
      CHECK(relative_error(d_input, golden.values(name + ".d_input")) < kTolerance);
      CHECK(relative_error(d_weight, golden.values(name + ".d_weight")) < kTolerance);
      if (d_bias.empty()) continue;
      CHECK(relative_error(d_bias, golden.values(name + ".d_bias")) < kTolerance);
    }
  }
  CHECK_FALSE(golden.has(kind + "." + std::to_string(cases) + ".shape"));  // that was all of them
}

}  // namespace

TEST_CASE("conv2d and its gradients equal PyTorch's with every instruction set") {
  check_all("conv2d", false, 6);
}

TEST_CASE("conv_transpose2d and its gradients equal PyTorch's with every instruction set") {
  check_all("conv_transpose2d", true, 4);
}

}  // namespace hqslam::nn

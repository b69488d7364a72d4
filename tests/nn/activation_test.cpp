#include "activation.h"

#include "golden.h"

namespace hqslam::nn {
namespace {

void check_against_pytorch(float slope, const std::string& name) {
  const Golden golden("layers");
  const Tensor values = tensor_of(golden.values(name + ".output"), 2, 3, 20);
  Tensor gradient = tensor_of(golden.values(name + ".d_output"), 2, 3, 20);
  leaky_relu_backward(slope, values, gradient);
  CHECK(relative_error(gradient, golden.values(name + ".d_input")) < 1e-6);
  CHECK(gradient.at(1, 2, -1) == gradient.at(1, 2, 19));
  CHECK(gradient.at(1, 2, 20) == gradient.at(1, 2, 0));
}

}  // namespace

TEST_CASE("ReLU's gradient equals PyTorch's") { check_against_pytorch(0.0F, "leaky_relu.0.0"); }

TEST_CASE("leaky ReLU's gradient equals PyTorch's") {
  check_against_pytorch(0.125F, "leaky_relu.0.125");
}

TEST_CASE("an output of 0 passes slope x gradient") {
  Tensor values(1, 1, 3, ColumnPadding::kCircular);
  values.at(0, 0, 0) = -0.5F;
  values.at(0, 0, 2) = 4.0F;
  Tensor gradient(1, 1, 3, ColumnPadding::kCircular);
  for (int x = 0; x < 3; ++x) gradient.at(0, 0, x) = 8.0F;
  leaky_relu_backward(0.25F, values, gradient);
  CHECK(gradient.at(0, 0, 0) == 2.0F);
  CHECK(gradient.at(0, 0, 1) == 2.0F);
  CHECK(gradient.at(0, 0, 2) == 8.0F);
}

}  // namespace hqslam::nn

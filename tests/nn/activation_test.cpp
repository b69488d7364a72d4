#include "activation.h"

#include "golden.h"

namespace hqslam::nn {
namespace {

void check_against_pytorch(float slope, const std::string& name) {
  const Golden golden("layers");
  Tensor values = tensor_of(golden.values(name + ".input"), 2, 3, 20);
  leaky_relu(slope, values);
  CHECK(relative_error(values, golden.values(name + ".output")) < 1e-6);
  Tensor gradient = tensor_of(golden.values(name + ".d_output"), 2, 3, 20);
  leaky_relu_backward(slope, values, gradient);
  CHECK(relative_error(gradient, golden.values(name + ".d_input")) < 1e-6);
  CHECK(gradient.at(1, 2, -1) == gradient.at(1, 2, 19));
  CHECK(gradient.at(1, 2, 20) == gradient.at(1, 2, 0));
}

}  // namespace

TEST_CASE("ReLU and its gradient equal PyTorch's") {
  check_against_pytorch(0.0F, "leaky_relu.0.0");
}

TEST_CASE("leaky ReLU and its gradient equal PyTorch's") {
  check_against_pytorch(0.125F, "leaky_relu.0.125");
}

TEST_CASE(
    "slope 1 is the identity, borders are filled, and an output of 0 passes slope x gradient") {
  Tensor values(1, 1, 3, ColumnPadding::kCircular);
  values.at(0, 0, 0) = -2.0F;
  values.at(0, 0, 2) = 4.0F;
  leaky_relu(1.0F, values);
  CHECK(values.at(0, 0, 0) == -2.0F);
  CHECK(values.at(0, 0, -1) == 4.0F);
  CHECK(values.at(0, 0, 3) == -2.0F);
  leaky_relu(0.25F, values);
  CHECK(values.at(0, 0, 0) == -0.5F);
  Tensor gradient(1, 1, 3, ColumnPadding::kCircular);
  for (int x = 0; x < 3; ++x) gradient.at(0, 0, x) = 8.0F;
  leaky_relu_backward(0.25F, values, gradient);
  CHECK(gradient.at(0, 0, 0) == 2.0F);
  CHECK(gradient.at(0, 0, 1) == 2.0F);
  CHECK(gradient.at(0, 0, 2) == 8.0F);
}

}  // namespace hqslam::nn

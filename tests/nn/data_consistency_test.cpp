#include "hqs/data_consistency.h"

#include <cmath>

#include "golden.h"

namespace hqslam::nn {
namespace {

/// Of tiles of 4 x 4 pixels whose last row is measured.
bool is_measured(int channel) { return channel / 4 == 3; }

Tensor of(const Golden& golden, const std::string& name) {
  return tensor_of(golden.values("data_consistency." + name), 16, 2, 20);
}

}  // namespace

TEST_CASE("data consistency and its gradients equal PyTorch's") {
  const Golden golden("layers");
  const Tensor l = of(golden, "l");
  const Tensor z = of(golden, "z");
  const Tensor y = of(golden, "y");
  const Tensor d_h = of(golden, "d_output");
  const float penalty = golden.value("data_consistency.penalty");
  Tensor h(16, 2, 20, ColumnPadding::kCircular);
  Tensor d_a = h;
  double d_penalty = 0.0;
  for (int channel = 0; channel < 16; ++channel) {
    for (int row = 0; row < 2; ++row) {
      const float* l_row = is_measured(channel) ? l.row(channel, row) : nullptr;
      data_consistency_row(l_row, z.row(channel, row), y.row(channel, row), penalty, 20,
                           h.row(channel, row));
      d_penalty +=
          data_consistency_gradient_row(l_row, z.row(channel, row), y.row(channel, row),
                                        d_h.row(channel, row), penalty, 20, d_a.row(channel, row));
    }
  }
  CHECK(relative_error(h, golden.values("data_consistency.output")) < 1e-5);
  CHECK(d_penalty == doctest::Approx(golden.value("data_consistency.d_penalty")).epsilon(1e-5));
  std::vector<float> half;  // A is the mean of Z and Y
  for (const float gradient : values_of(d_a)) half.push_back(0.5F * gradient);
  CHECK(relative_error(half, golden.values("data_consistency.d_z")) < 1e-5);
  CHECK(relative_error(half, golden.values("data_consistency.d_y")) < 1e-5);
}

TEST_CASE("measured pixels weigh L against the mean of Z and Y, others are the mean") {
  const float l = 8.0F;
  const float z = 1.0F;
  const float y = 3.0F;
  const auto h = [&](bool measured, float penalty) {
    float result = 0.0F;
    data_consistency_row(measured ? &l : nullptr, &z, &y, penalty, 1, &result);
    return result;
  };
  CHECK(h(false, 0.5F) == 2.0F);  // (1 + 3) / 2
  CHECK(h(true, 0.5F) == 5.0F);   // (8 + 2 * 0.5 * 2) / (1 + 2 * 0.5)
  CHECK(h(true, 0.0F) == 8.0F);   // the limit: what was measured stays
  float last = 0.0F;
  for (const float penalty : {1e-6F, 0.01F, 0.1F, 1.0F, 100.0F}) {
    const float distance = std::fabs(h(true, penalty) - l);
    CHECK(distance > last);  // the smaller the penalty, the closer to L
    last = distance;
  }
  CHECK(last < std::fabs(2.0F - l));
}

}  // namespace hqslam::nn

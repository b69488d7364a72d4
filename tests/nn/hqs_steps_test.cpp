
#include "golden.h"
#include "hqs/hqs_backward.h"
#include "hqs/hqs_network.h"
#include "small_network.h"

// The steps of the loop by themselves: data consistency, the loss, the result.
namespace hqslam::nn {
namespace {

/// For tiles of 4 x 4 pixels whose last row is measured.
bool is_measured_channel(int channel) { return channel / 4 == 3; }

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
      const float* l_row = is_measured_channel(channel) ? l.row(channel, row) : nullptr;
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

TEST_CASE("the L1 loss with measured rows and its gradient equal PyTorch's") {
  const Golden golden("layers");
  const Tensor z = tensor_of(golden.values("l1_loss.z"), 16, 2, 20);
  const Tensor truth = tensor_of(golden.values("l1_loss.truth"), 16, 2, 20);
  Tensor d_z = z;
  const double loss = l1_loss(z, truth, {4, 4}, RowSelection{3, 4}, 1.0F, d_z);
  CHECK(loss == doctest::Approx(golden.value("l1_loss.loss")).epsilon(1e-6));
  CHECK(relative_error(d_z, golden.values("l1_loss.d_z")) < 1e-6);
}

TEST_CASE("measured rows count as exact, equal values have no gradient") {
  Tensor z(1, 2, 2, ColumnPadding::kZero);
  Tensor truth = z;
  Tensor d_z = z;
  z.at(0, 0, 0) = 3.0F;
  truth.at(0, 0, 0) = 5.0F;
  z.at(0, 0, 1) = truth.at(0, 0, 1) = 2.0F;
  z.at(0, 1, 0) = 100.0F;
  for (int x = 0; x < 2; ++x) d_z.at(0, 1, x) = 9.0F;  // left from the last time
  CHECK(l1_loss(z, truth, {}, RowSelection{1, 2}, 1.0F, d_z) == doctest::Approx(0.5));
  CHECK(d_z.at(0, 0, 0) == -0.25F);
  CHECK(d_z.at(0, 0, 1) == 0.0F);
  CHECK(d_z.at(0, 1, 0) == 0.0F);
  CHECK(d_z.at(0, 1, 1) == 0.0F);
}

TEST_CASE("the result is in metres, within the sensor's limits, with the measured rows put back") {
  const HqsPlan description = small_du_or();
  std::vector<float> image(16 * 64, 0.25F);  // 20 m
  image[0] = 0.001F;                         // 0.08 m: too near
  image[1] = 1.6F;                           // 128 m: too far
  image[2] = -0.25F;
  image[3] = std::nanf("");
  image[4] = 1.5F;  // 120 m, the limit itself
  Tensor z(16, 4, 16, ColumnPadding::kCircular);
  to_tiles(image.data(), {4, 4}, z);
  RangeImage measured(4, 64);
  for (int i = 0; i < 4 * 64; ++i) measured.range_m[i] = 130.0F + static_cast<float>(i);
  measured.at(2, 5) = 0.0F;
  RangeImage result(16, 64);
  restore_rows(description, {4, 4}, z, measured, result);
  for (int column = 0; column < 4; ++column) CHECK(result.at(0, column) == 0.0F);
  CHECK(result.at(0, 4) == 120.0F);
  for (int row = 0; row < 16; ++row) {
    for (int column = 5; column < 64; ++column) {
      const float expected = row % 4 == 3 ? measured.at(row / 4, column) : 20.0F;
      REQUIRE(result.at(row, column) == expected);
    }
  }
}

}  // namespace hqslam::nn

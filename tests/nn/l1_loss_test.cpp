#include "hqs/l1_loss.h"

#include "golden.h"

namespace hqslam::nn {

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

}  // namespace hqslam::nn

#include "hqs/data_consistency.h"

#include "golden.h"
#include "random_values.h"

namespace hqslam::nn {
namespace {

constexpr TileSize kTile{4, 4};
constexpr RowSelection kMeasured{3, 4};

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
  const DataConsistency step{kTile, kMeasured, golden.value("data_consistency.penalty")};
  Tensor h(16, 2, 20, ColumnPadding::kCircular);
  for (int row = 0; row < h.rows(); ++row) step.forward_row(l, z, y, row, h);
  CHECK(relative_error(h, golden.values("data_consistency.output")) < 1e-5);
  CHECK(h.at(12, 1, -1) == h.at(12, 1, 19));
  Tensor d_a = h;
  const double d_penalty = step.backward(l, z, y, d_h, d_a);
  CHECK(d_penalty == doctest::Approx(golden.value("data_consistency.d_penalty")).epsilon(1e-5));
  std::vector<float> half;  // A is the mean of Z and Y
  for (const float gradient : values_of(d_a)) half.push_back(0.5F * gradient);
  CHECK(relative_error(half, golden.values("data_consistency.d_z")) < 1e-5);
  CHECK(relative_error(half, golden.values("data_consistency.d_y")) < 1e-5);
}

TEST_CASE("measured rows weigh L against the mean of Z and Y, other rows are the mean") {
  const DataConsistency step{{}, {1, 2}, 0.5F};
  Tensor l(1, 2, 3, ColumnPadding::kZero);
  Tensor z = l;
  Tensor y = l;
  Tensor h = l;
  for (int row = 0; row < 2; ++row) {
    l.at(0, row, 1) = 8.0F;
    z.at(0, row, 1) = 1.0F;
    y.at(0, row, 1) = 3.0F;
  }
  for (int row = 0; row < 2; ++row) step.forward_row(l, z, y, row, h);
  CHECK(h.at(0, 0, 1) == 2.0F);  // (1 + 3) / 2
  CHECK(h.at(0, 1, 1) == 5.0F);  // (8 + 2 * 0.5 * 2) / (1 + 2 * 0.5)
}

TEST_CASE("the smaller the penalty, the closer measured rows are to L") {
  Tensor l(1, 1, 16, ColumnPadding::kZero);
  Tensor z = l;
  fill_random(1, l);
  fill_random(2, z);
  float last = 0.0F;
  for (const float penalty : {1e-6F, 0.01F, 0.1F, 1.0F, 100.0F}) {
    Tensor h = l;
    DataConsistency{{}, {0, 1}, penalty}.forward_row(l, z, z, 0, h);
    const float distance = std::fabs(h.at(0, 0, 5) - l.at(0, 0, 5));
    CHECK(distance > last);
    last = distance;
  }
  CHECK(last < std::fabs(z.at(0, 0, 5) - l.at(0, 0, 5)));
}

TEST_CASE("data consistency leaves the memory channels alone") {
  Tensor l(16, 4, 20, ColumnPadding::kCircular);
  Tensor z = l;
  fill_random(3, l);
  fill_random(4, z);
  Tensor h(18, 4, 20, ColumnPadding::kCircular);
  fill_random(5, h);
  const float kept = h.at(16, 2, 7);
  DataConsistency{kTile, kMeasured, 0.2F}.forward_row(l, z, z, 2, h);
  CHECK(h.at(16, 2, 7) == kept);
}

}  // namespace hqslam::nn

#include "disturbance.h"

#include <doctest/doctest.h>

#include <cmath>

#include "random.h"
#include "small_sensor.h"

using namespace hqslam;
using namespace hqslam::sim;
using namespace hqslam::test;

namespace {

constexpr int kPixels = 20'000;

std::vector<float> disturbed(float range_m, const SensingConditions& conditions) {
  std::vector<float> ranges_m;
  for (int k = 0; k < kPixels; ++k) {
    ranges_m.push_back(disturbed_range_m(range_m, conditions, small_sensor(), seed_of(9, k)));
  }
  return ranges_m;
}

}  // namespace

TEST_CASE("fog takes what Beer and Lambert say, within a tenth where anything is left to see") {
  CHECK(transmission(0.0, 50.0) == 1.0);
  for (const double depth : {0.01, 0.1, 0.5, 1.0}) {
    CHECK(transmission(0.02, depth / 0.02) == doctest::Approx(std::exp(-2.0 * depth)).epsilon(0.1));
  }
  CHECK(transmission(0.05, 100.0) < 0.002);
}

TEST_CASE("on a clear day a pixel reports what it would report") {
  CHECK(disturbed_range_m(12.345F, {}, small_sensor(), 1) == 12.345F);
  CHECK(disturbed_range_m(0.0F, {}, small_sensor(), 1) == 0.0F);
}

TEST_CASE("drop-outs take their share of the returns and leave the others as they are") {
  int lost = 0;
  for (const float range_m : disturbed(12.345F, {.dropout_share = 0.1})) {
    CHECK((range_m == 0.0F || range_m == 12.345F));
    lost += range_m == 0.0F ? 1 : 0;
  }
  CHECK(lost == doctest::Approx(0.1 * kPixels).epsilon(0.1));
}

TEST_CASE("extra noise has no mean and its standard deviation; beyond the limits nothing is seen") {
  double sum = 0.0;
  double squares = 0.0;
  for (const float range_m : disturbed(12.0F, {.extra_range_noise_m = 0.05})) {
    sum += range_m - 12.0;
    squares += (range_m - 12.0) * (range_m - 12.0);
  }
  CHECK(std::abs(sum / kPixels) < 0.002);
  CHECK(std::sqrt(squares / kPixels) == doctest::Approx(0.05).epsilon(0.03));
  int lost = 0;
  for (const float range_m : disturbed(120.0F, {.extra_range_noise_m = 0.05})) {
    CHECK(range_m <= 120.0F);
    lost += range_m == 0.0F ? 1 : 0;
  }
  CHECK(lost == doctest::Approx(0.5 * kPixels).epsilon(0.05));
}

TEST_CASE("drops in the air are near, never behind what is seen, and hide it in their share") {
  int nearer = 0;
  for (const float range_m : disturbed(6.0F, {.airborne_share = 0.2})) {
    CHECK(range_m >= 0.5F);
    CHECK(range_m <= 6.0F);
    nearer += range_m < 6.0F ? 1 : 0;
  }
  // r_d = 0.5 m + 12 m u^2 is nearer than 6 m for u below 0.677.
  CHECK(nearer == doctest::Approx(0.2 * 0.677 * kPixels).epsilon(0.1));
  int seen = 0;
  for (const float range_m : disturbed(0.0F, {.airborne_share = 0.2})) {
    CHECK(range_m <= 12.5F);
    seen += range_m > 0.0F ? 1 : 0;
  }
  CHECK(seen == doctest::Approx(0.2 * kPixels).epsilon(0.1));
}

#include "echo.h"

#include <doctest/doctest.h>

#include <cmath>

#include "random.h"

using namespace hqslam::sim;

namespace {

std::optional<Echo> reported(const Echo& near, double near_weight, const Echo& far,
                             double far_weight) {
  Footprint footprint;
  footprint.add(near, near_weight);
  footprint.add(far, far_weight);
  return footprint.reported_echo();
}

double detected_share(double range_m, const Surface& surface, double cos_incidence) {
  int detected = 0;
  constexpr int kTries = 4000;
  for (int k = 0; k < kTries; ++k) {
    const auto echo = echo_of({range_m, cos_incidence, surface}, 120.0, {});
    if (detected_range_m(*echo, 0.5, 120.0, seed_of(3, static_cast<std::uint64_t>(k))) > 0.0F) {
      ++detected;
    }
  }
  return static_cast<double>(detected) / kTries;
}

}  // namespace

TEST_CASE("echoes within a pulse melt into their mean by power, others do not") {
  const auto mixed = reported({10.0, 4.0}, 2.0, {10.5, 8.0}, 1.0);
  REQUIRE(mixed);
  CHECK(mixed->range_m == doctest::Approx(10.25));
  const auto strongest = reported({10.0, 1.0}, 2.0, {14.0, 5.0}, 1.0);
  REQUIRE(strongest);
  CHECK(strongest->range_m == doctest::Approx(14.0));
  CHECK(strongest->signal == doctest::Approx(5.0 / 3.0));
  CHECK_FALSE(Footprint{}.reported_echo());
}

TEST_CASE("drop-outs grow with range, with grazing incidence and on dark surfaces") {
  const Surface bright{Material::kPlaster, 255};
  const Surface dark{Material::kCarPaint, 10};
  CHECK(detected_share(20.0, bright, 1.0) > 0.99);
  CHECK(detected_share(70.0, bright, 1.0) > detected_share(105.0, bright, 1.0) + 0.1);
  CHECK(detected_share(105.0, bright, 1.0) > detected_share(118.0, bright, 1.0) + 0.05);
  CHECK(detected_share(90.0, bright, 1.0) > detected_share(90.0, bright, 0.1) + 0.3);
  CHECK(detected_share(40.0, bright, 1.0) > detected_share(40.0, dark, 1.0) + 0.5);
}

TEST_CASE("range noise has mean 0 and the stated deviation, in whole millimetres") {
  const Echo echo{20.0, 25.0};
  double sum = 0.0;
  double sum_of_squares = 0.0;
  int count = 0;
  for (std::uint64_t k = 0; k < 20000; ++k) {
    const float range_m = detected_range_m(echo, 0.5, 120.0, seed_of(1, k));
    if (range_m == 0.0F) continue;
    const double error_m = static_cast<double>(range_m) - 20.0;
    CHECK(std::abs(range_m * 1000.0F - std::round(range_m * 1000.0F)) < 0.01F);
    sum += error_m;
    sum_of_squares += error_m * error_m;
    ++count;
  }
  REQUIRE(count > 19900);
  CHECK(std::abs(sum / count) < 3e-4);
  CHECK(std::sqrt(sum_of_squares / count) == doctest::Approx(0.008 + 0.008 / 5.0).epsilon(0.03));
}

TEST_CASE("ranges outside the sensor's limits are no returns") {
  for (std::uint64_t k = 0; k < 200; ++k) {
    CHECK(detected_range_m({0.4, 1e6}, 0.5, 120.0, seed_of(1, k)) == 0.0F);
    CHECK(detected_range_m({120.2, 1e6}, 0.5, 120.0, seed_of(1, k)) == 0.0F);
  }
}

TEST_CASE("neighbouring pixels of a window mostly agree, and some windows lose the beam") {
  int lost = 0;
  int disagreements = 0;
  constexpr int kPatches = 2000;
  for (std::uint64_t patch = 0; patch < kPatches; ++patch) {
    const RayHit hit{12.0, 0.7, {Material::kGlass, static_cast<std::uint8_t>(patch % 256)}};
    const std::uint64_t bits = seed_of(2, patch);
    const bool a = echo_of(hit, 120.0, {seed_of(3, patch), bits}).has_value();
    const bool b = echo_of(hit, 120.0, {seed_of(4, patch), bits}).has_value();
    lost += a ? 0 : 1;
    disagreements += a == b ? 0 : 1;
  }
  CHECK(lost > 0.15 * kPatches);
  CHECK(lost < 0.7 * kPatches);
  CHECK(disagreements < 0.1 * kPatches);
}

#include "echo.h"

#include "sample_statistics.h"
#include "small_city.h"

using namespace hqslam::sim;

namespace {

std::optional<Echo> reported(const Echo& near, double near_weight, const Echo& far,
                             double far_weight) {
  Footprint footprint;
  footprint.add(near, near_weight);
  footprint.add(far, far_weight);
  return footprint.reported_echo();
}

}  // namespace

TEST_CASE("echoes within a pulse melt into their mean by power, others do not") {
  CHECK(reported({10.0, 4.0}, 2.0, {10.5, 8.0}, 1.0).value().range_m == doctest::Approx(10.25));
  const auto strongest = reported({10.0, 1.0}, 2.0, {14.0, 5.0}, 1.0).value();
  CHECK(strongest.range_m == doctest::Approx(14.0));
  CHECK(strongest.signal == doctest::Approx(5.0 / 3.0));
  CHECK_FALSE(Footprint{}.reported_echo());
}

TEST_CASE("range noise has mean 0 and the stated deviation, in whole millimetres") {
  const Echo echo{20.0, 25.0};
  std::vector<double> errors_m;
  for (std::uint64_t k = 0; k < 20000; ++k) {
    const float range_m = detected_range_m(echo, 0.5, 120.0, seed_of(1, k));
    if (range_m == 0.0F) continue;
    CHECK(std::abs(range_m * 1000.0F - std::round(range_m * 1000.0F)) < 0.01F);
    errors_m.push_back(static_cast<double>(range_m) - 20.0);
  }
  REQUIRE(errors_m.size() > 19900);
  CHECK(std::abs(mean_of(errors_m)) < 3e-4);
  CHECK(deviation_of(errors_m) == doctest::Approx(0.008 + 0.008 / 5.0).epsilon(0.03));
}

TEST_CASE("intensity is of the surface and how it is met, not of its distance") {
  const auto intensity = [](Material material, double range_m, double cosine) {
    return int{intensity_of(*echo_of({range_m, cosine, {material, 255}}, 120.0, {}), 120.0)};
  };
  for (const double range_m : {0.05, 2.0, 30.0, 110.0}) {
    CHECK(intensity(Material::kPlaster, range_m, 1.0) == 70);
    CHECK(intensity(Material::kPlaster, range_m, 0.25) == std::lround(70 * std::pow(0.25, 0.375)));
    CHECK(intensity(Material::kRubber, range_m, 1.0) == 10);
    CHECK(intensity(Material::kRetroreflector, range_m, 1.0) == 255);
  }
  const Return drops = disturbed_return({}, {.airborne_share = 1.0 - 1e-9}, small_sensor(), 1);
  CHECK(drops.range_m > 0.0F);
  CHECK(drops.intensity == 2);
}

TEST_CASE("drops in the air are near, never behind what is seen, and hide it in their share") {
  constexpr int kPixels = 20'000;
  // Drops are at 0.5 m + 12 m u^2: nearer than 6 m for u below 0.677.
  for (const auto& [range_m, farthest_m, share] :
       {std::tuple(6.0F, 6.0F, 0.2 * 0.677), {0.0F, 12.5F, 0.2}}) {
    int drops = 0;
    for (int k = 0; k < kPixels; ++k) {
      const float seen_m =
          disturbed_return({range_m, 40}, {.airborne_share = 0.2}, small_sensor(), seed_of(9, k))
              .range_m;
      if (seen_m == range_m) continue;
      CHECK(seen_m >= 0.5F);
      CHECK(seen_m <= farthest_m);
      ++drops;
    }
    CHECK(drops == doctest::Approx(share * kPixels).epsilon(0.1));
  }
}

#include "map/choice_of_start.h"

#include "testing.h"

namespace {

/// A scan with `sought` planes to be found, of which `close` were found close to the map.
slam::MappingResult fit(int close, int sought) {
  slam::MappingResult result;
  result.close_planes = close;
  result.close_ratio = static_cast<double>(close) / sought;
  return result;
}

}  // namespace

TEST_CASE("of 100 close planes fifteen more are chance, of 1000 a hundred and fifty are not") {
  CHECK(slam::fits_better(fit(124, 514), fit(109, 514)));
  CHECK_FALSE(slam::fits_better_than_chance(fit(124, 514), fit(109, 514)));
  CHECK(slam::fits_better_than_chance(fit(150, 514), fit(109, 514)));
  CHECK(slam::fits_better_than_chance(fit(1150, 4000), fit(1000, 4000)));
}

TEST_CASE("a gain of less than a tenth does not count, however many planes are close") {
  CHECK_FALSE(slam::fits_better_than_chance(fit(10900, 20000), fit(10000, 20000)));
}

TEST_CASE("any fit is better than too few features") {
  slam::MappingResult nothing;
  nothing.status = slam::Status::kTooFewFeatures;
  CHECK(slam::fits_better_than_chance(fit(10, 500), nothing));
  CHECK_FALSE(slam::fits_better_than_chance(nothing, fit(0, 500)));
}

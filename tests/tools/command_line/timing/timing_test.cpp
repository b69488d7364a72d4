#include "timing/timing.h"

#include "testing.h"

namespace hqslam::tools {

TEST_CASE("statistics of 1..20, of a single value (itself) and of none (zeros)") {
  std::vector<double> values;
  for (int i = 20; i >= 1; --i) values.push_back(i);
  const Distribution distribution = distribution_of(values);
  CHECK(distribution.median == doctest::Approx(10.5));
  CHECK(distribution.p95 == doctest::Approx(19.0));
  CHECK(distribution.max == doctest::Approx(20.0));
  CHECK(distribution.mean == doctest::Approx(10.5));
  const Distribution one = distribution_of({3.0});
  CHECK(one.median == 3.0);
  CHECK(one.p95 == 3.0);
  CHECK(one.max == 3.0);
  CHECK(distribution_of({}).max == 0.0);
}

}  // namespace hqslam::tools

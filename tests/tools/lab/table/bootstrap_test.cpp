#include "table/bootstrap.h"

#include "testing.h"

namespace hqslam::tools {
namespace {

Estimate mean_of(const std::vector<double>& values) {
  return bootstrap(values.size(), [&](const std::vector<std::size_t>& members) {
    double sum = 0.0;
    for (const std::size_t member : members) sum += values[member];
    return sum / static_cast<double>(members.size());
  });
}

}  // namespace

// Of two members 0 and 1 a quarter of the draws has mean 0, a quarter 1.
TEST_CASE("a sample of equal values has no doubt, two that differ span the whole interval") {
  for (const std::vector<double>& values : {std::vector{3.0, 3.0, 3.0, 3.0}, {0.0, 1.0}}) {
    const Estimate estimate = mean_of(values);
    CHECK(estimate.value == 0.5 * (values.front() + values.back()));
    CHECK(estimate.low == values.front());
    CHECK(estimate.high == values.back());
  }
}

// The mean of n draws has the deviation s / sqrt(n); its distribution is near the normal one.
TEST_CASE("the interval of a mean is that of the normal distribution, where there are many") {
  std::vector<double> values;
  for (int i = 0; i < 400; ++i) values.push_back(i % 2 == 0 ? 1.0 : -1.0);
  const Estimate estimate = mean_of(values);
  CHECK(estimate.low == doctest::Approx(-1.96 / 20.0).epsilon(0.06));
  CHECK(estimate.high == doctest::Approx(1.96 / 20.0).epsilon(0.06));
}

TEST_CASE("one member, or a figure that most draws do not have, has no interval") {
  const Estimate single = mean_of({2.0});
  CHECK(single.value == 2.0);
  CHECK(std::isnan(single.low));
  const Estimate seldom = bootstrap(3, [](const std::vector<std::size_t>& members) {
    const bool all = members == std::vector<std::size_t>{0, 1, 2};
    return all ? 1.0 : std::numeric_limits<double>::quiet_NaN();
  });
  CHECK(seldom.value == 1.0);
  CHECK(std::isnan(seldom.high));
}

}  // namespace hqslam::tools

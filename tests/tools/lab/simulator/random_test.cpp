#include "random.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "sample_statistics.h"

using namespace hqslam::sim;
using namespace hqslam::test;

TEST_CASE("scrambled is splitmix64: the published first numbers of seed 0") {
  CHECK(scrambled(0) == 0xe220a8397b1dcdafULL);
  CHECK(scrambled(0x9e3779b97f4a7c15ULL) == 0x6e789e6aa1b965f4ULL);
}

TEST_CASE("normal_of has mean 0, variance 1 and stays within 3.47") {
  Random random(5);
  std::vector<double> values(200'000);
  for (double& value : values) value = random.normal();
  CHECK(std::abs(mean_of(values)) < 0.01);
  CHECK(deviation_of(values) == doctest::Approx(1.0).epsilon(0.005));
  CHECK(std::ranges::all_of(values, [](double value) { return std::abs(value) < 3.47; }));
}

TEST_CASE("uniform numbers fill [0, 1) evenly and below() reaches every value") {
  Random random(9);
  int bins[10] = {};
  for (int k = 0; k < 100000; ++k) {
    const double value = random.uniform();
    REQUIRE(value >= 0.0);
    REQUIRE(value < 1.0);
    ++bins[static_cast<int>(value * 10.0)];
  }
  for (const int count : bins) CHECK(std::abs(count - 10000) < 500);
  int seen = 0;
  for (int k = 0; k < 200; ++k) seen |= 1 << random.below(5);
  CHECK(seen == 0b11111);
}

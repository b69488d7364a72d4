#include "random.h"

#include <doctest/doctest.h>

#include <cmath>

using namespace hqslam::sim;

TEST_CASE("scrambled is splitmix64: the published first numbers of seed 0") {
  CHECK(scrambled(0) == 0xe220a8397b1dcdafULL);
  CHECK(scrambled(0x9e3779b97f4a7c15ULL) == 0x6e789e6aa1b965f4ULL);
}

TEST_CASE("normal_of has mean 0, variance 1 and stays within 3.47") {
  double sum = 0.0;
  double sum_of_squares = 0.0;
  double largest = 0.0;
  constexpr int kCount = 200000;
  Random random(5);
  for (int k = 0; k < kCount; ++k) {
    const double value = random.normal();
    sum += value;
    sum_of_squares += value * value;
    largest = std::max(largest, std::abs(value));
  }
  CHECK(std::abs(sum / kCount) < 0.01);
  CHECK(sum_of_squares / kCount == doctest::Approx(1.0).epsilon(0.01));
  CHECK(largest < 3.47);
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

#include "front_end/scan_clock.h"

#include <doctest/doctest.h>

#include <vector>

using hqslam::slam::ScanClock;

namespace {

/// Of a sensor with a period of 0.1 s.
std::vector<double> times_s(const std::vector<double>& stamps_s) {
  ScanClock clock(0.1);
  std::vector<double> times_s;
  for (const double stamp_s : stamps_s) times_s.push_back(clock.time_s(stamp_s));
  return times_s;
}

/// Steps of the time from scan to scan.
void check_steps(const std::vector<double>& stamps_s, const std::vector<double>& expected_s) {
  const std::vector<double> found_s = times_s(stamps_s);
  REQUIRE(found_s.size() == expected_s.size() + 1);
  for (std::size_t i = 0; i < expected_s.size(); ++i) {
    CAPTURE(i);
    CHECK(found_s[i + 1] - found_s[i] == doctest::Approx(expected_s[i]).epsilon(1e-4));
  }
}

}  // namespace

TEST_CASE(
    "stamps that run on, faster, slower or with scans missing, are the time to the last bit") {
  const std::vector<double> stamps_s{1.7e9, 1.7e9 + 0.1, 1.7e9 + 0.15, 1.7e9 + 0.6, 1.7e9 + 9.6};
  CHECK(times_s(stamps_s) == stamps_s);
}

TEST_CASE("late stamps count as a period, and the time is that of the clock again after them") {
  check_steps({0.1, 0.2, 0.2001, 0.4}, {0.1, 0.1, 0.1});
  check_steps({0.1, 0.2, 0.2001, 0.2002, 0.5, 0.6}, {0.1, 0.1, 0.1, 0.1, 0.1});
  check_steps({1.0, 1.0, 1.0, 0.5, 0.5}, {0.1, 0.1, 0.1, 0.1});
}

TEST_CASE("a clock that is set, forward or back, counts as a period and runs on from there") {
  check_steps({3.0, 3.1, 1.7e9, 1.7e9 + 0.1, 1.7e9 + 0.3, 1.7e9 + 0.4}, {0.1, 0.1, 0.1, 0.2, 0.1});
  check_steps({1.7e9, 1.7e9 + 0.1, 5.0, 5.1, 5.3, 5.4}, {0.1, 0.1, 0.1, 0.2, 0.1});
}

#include "front_end/scan_clock.h"

#include "testing.h"

using hqslam::slam::ScanClock;

namespace {

/// Steps of the time from scan to scan, of a sensor with a period of 0.1 s.
void check_steps(const std::vector<double>& stamps_s, const std::vector<double>& expected_s) {
  REQUIRE(stamps_s.size() == expected_s.size() + 1);
  ScanClock clock(0.1);
  double last_s = clock.time_s(stamps_s.front());
  for (std::size_t i = 0; i < expected_s.size(); ++i) {
    CAPTURE(i);
    const double time_s = clock.time_s(stamps_s[i + 1]);
    CHECK(time_s - last_s == doctest::Approx(expected_s[i]).epsilon(1e-4));
    last_s = time_s;
  }
}

}  // namespace

TEST_CASE("stamps that run on, at any rate or with scans missing, are the time to the bit") {
  ScanClock clock(0.1);
  for (const double stamp_s : {1.7e9, 1.7e9 + 0.1, 1.7e9 + 0.15, 1.7e9 + 0.6, 1.7e9 + 9.6}) {
    CHECK(clock.time_s(stamp_s) == stamp_s);
  }
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

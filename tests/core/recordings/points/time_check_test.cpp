#include "points/time_check.h"

#include "hqslam/core/angles.h"
#include "testing.h"

using namespace hqslam::recordings;

namespace {

/// Points around the sensor, up to `end_deg` from where it begins, clockwise as the times rise.
Scan turn(double last_s, double end_deg = 360.0, double direction = 1.0) {
  constexpr int kPoints = 720;
  Scan scan;
  for (int i = 0; i < kPoints; ++i) {
    const double share = static_cast<double>(i) / kPoints;
    const double azimuth_rad = -direction * share * end_deg * kDegree_rad;
    scan.points_m.emplace_back(std::cos(azimuth_rad), std::sin(azimuth_rad), 0.1);
    scan.time_offset_s.push_back(static_cast<float>(share * last_s));
  }
  return scan;
}

}  // namespace

TEST_CASE("times of a whole turn that are all one or a tenth are removed, with one warning") {
  for (const double last_s : {0.0, 0.01}) {
    TimeCheck check;
    Scan scan = turn(last_s);
    CHECK(check.check(scan, 0.1).find("at least 0.025 s") != std::string::npos);
    CHECK(scan.time_offset_s.empty());
    scan = turn(last_s);
    CHECK(check.check(scan, 0.1).empty());
    CHECK(scan.time_offset_s.empty());
  }
}

TEST_CASE("times of turns at 5 to 20 Hz, of parts of a turn and of scans without any stay") {
  for (Scan scan : {turn(0.05), turn(0.1), turn(0.2), turn(0.01, 36.0), Scan()}) {
    const auto before = scan.time_offset_s;
    TimeCheck check;
    CHECK(check.check(scan, before.empty() ? 0.1 : before.back()).empty());
    CHECK(scan.time_offset_s == before);
  }
}

TEST_CASE("times that rise counterclockwise stay, with a warning") {
  TimeCheck check;
  Scan scan = turn(0.1, 360.0, -1.0);
  CHECK(check.check(scan, 0.1).find("counterclockwise") != std::string::npos);
  CHECK(scan.time_offset_s.size() == scan.points_m.size());
}

// What SLAM knows of the sensor from scan to scan: starting, tracking, lost, searching.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "hqslam/slam/options.h"
#include "hqslam/slam/saved_map.h"
#include "hqslam/slam/scan_trace.h"
#include "hqslam/slam/slam.h"
#include "slam/village.h"
#include "slam/yard.h"

using namespace hqslam;
using slam::Status;

namespace {

SensorModel sensor() { return test::small_sensor(16, 360); }

test::Village street(unsigned seed) {
  test::Village village;
  village.add_street(-40.0, 0.0, 160.0, seed);
  return village;
}

/// '-' starting, 't' tracking, 'l' lost, '?' searching.
char letter(std::string_view state) {
  return state == "starting" ? '-' : state == "searching" ? '?' : state.front();
}

/// A drive along a street of which single scans are others.
class Drive {
 public:
  explicit Drive(slam::Slam slam = slam::Slam(sensor())) : slam_(std::move(slam)) {}

  /// 's': sees the street; 'b': is blind; 'e': stands in another street.
  std::string states(const std::string& scans) {
    std::string result;
    for (const char what : scans) {
      OrganizedCloud cloud = (what == 'e' ? elsewhere_ : street_).scan(sensor(), pose());
      if (what == 'b') cloud = OrganizedCloud(cloud.rows, cloud.columns);
      report = slam_.process(cloud, 0.1 * scans_++, &trace);
      result += letter(trace.state);
    }
    return result;
  }
  slam::Slam& slam() { return slam_; }

  slam::ScanReport report;
  slam::ScanTrace trace;

 private:
  Pose pose() const { return test::yard_pose(0.3 * scans_, 0.0, 0.0); }

  slam::Slam slam_;
  test::Village street_ = street(31);
  test::Village elsewhere_ = street(77);
  int scans_ = 0;
};

}  // namespace

TEST_CASE("SLAM starts with the first scan that has enough features") {
  CHECK(Drive().states("bbs") == "--t");
  Drive drive;
  drive.states("bb");
  CHECK(drive.trace.state_before == "starting");
  CHECK(drive.trace.state == "starting");
  CHECK(drive.report.mapping_status == Status::kTooFewFeatures);
  drive.states("s");
  CHECK(drive.trace.state == "tracking");
  CHECK(drive.report.keyframe);
}

TEST_CASE("up to five scans that miss the map are bridged, whatever they are") {
  for (const std::string missed : {"b", "bbbbb", "e", "eeeee", "beebe"}) {
    CAPTURE(missed);
    Drive drive;
    drive.states("ssssssss");
    CHECK(drive.states(missed) == std::string(missed.size(), 'l'));
    CHECK(drive.states("sss") == "ttt");
    CHECK(drive.slam().segment_of_scan().back() == 0);
  }
}

TEST_CASE("a scan of which much less fits than of the last registered one stands elsewhere") {
  Drive drive;
  drive.states("ssssss");
  CHECK(drive.trace.last_inlier_ratio > 0.0);
  CHECK(drive.trace.inlier_ratio > 0.6 * drive.trace.last_inlier_ratio);
  drive.states("e");
  CHECK(drive.trace.inlier_ratio < 0.6 * drive.trace.last_inlier_ratio);
  CHECK(!is_registered(drive.report.mapping_status));
  // Of the last registered one: what is missed in between does not count.
  const double last = drive.trace.last_inlier_ratio;
  drive.states("e");
  CHECK(drive.trace.last_inlier_ratio == last);
}

TEST_CASE("with the sixth missed scan the way is lost: a segment begins where something is seen") {
  Drive drive;
  drive.states("ssssss");
  CHECK(drive.states("eeeee") == "lllll");
  CHECK(drive.states("e") == "t");
  CHECK(drive.report.keyframe);
  CHECK(drive.slam().segment_of_scan() ==
        std::vector<std::size_t>{0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1});
  Drive blind;
  blind.states("ssssss");
  CHECK(blind.states("bbbbbbbb") == "llllllll");  // nothing to begin with
  CHECK(blind.slam().segment_of_scan().back() == 0);
}

TEST_CASE("in a given map a sensor is searched for until it is found, and after it was lost") {
  Drive mapped;
  mapped.states(std::string(120, 's'));
  mapped.slam().finish();
  Drive drive(slam::Slam(sensor(), slam::SlamOptions(), mapped.slam().saved_map()));
  CHECK(drive.states("eb") == "??");
  CHECK(drive.states("ss") == "tt");
  CHECK(drive.states("bbbbbb") == "lllll?");
  CHECK(drive.report.mapping_status == Status::kTooFewFeatures);
  CHECK(drive.states("b") == "?");
  CHECK(drive.report.mapping_status == Status::kNotRecognized);
  CHECK(drive.states("ss") == "tt");
}

TEST_CASE("a trace has each feature with its match, and asking for it changes nothing") {
  slam::Slam plain(sensor());
  Drive drive;
  const test::Village village = street(31);
  for (int i = 0; i < 8; ++i) {
    const auto report =
        plain.process(village.scan(sensor(), test::yard_pose(0.3 * i, 0.0, 0.0)), 0.1 * i);
    drive.states("s");
    CHECK(report.T_map_sensor.matrix() == drive.report.T_map_sensor.matrix());
    CHECK(report.covariance == drive.report.covariance);
  }
  const slam::ScanTrace& trace = drive.trace;
  const slam::ScanReport& report = drive.report;
  CHECK(trace.pixel_class.size() == trace.cloud.range_m.size());
  CHECK(std::count(trace.pixel_class.begin(), trace.pixel_class.end(), slam::PixelClass::kGround) ==
        report.ground_points);
  int edges = 0;
  int planes = 0;
  for (const slam::TracedFeature& feature : trace.features) {
    const std::size_t pixel = trace.cloud.index(feature.row, feature.column);
    CHECK((trace.cloud.points_m[pixel] - feature.point_m).norm() < 1.0);
    if (!feature.is_matched) continue;
    const bool is_line =
        feature.kind == slam::FeatureKind::kEdge || feature.kind == slam::FeatureKind::kPost;
    ++(is_line ? edges : planes);
    CHECK(feature.weight_per_m > 0.0);
    const Eigen::Vector3d on_scan_m = trace.T_map_level * feature.point_m.cast<double>();
    if (!is_line) {
      // On the ground the part along the vertical alone is asked for, so it is a little less.
      CHECK((feature.on_map_m.cast<double>() - on_scan_m).norm() < feature.residual_m + 1e-3);
    }
  }
  // The last search was made where the last but one step led.
  CHECK(std::abs(edges - report.edge_correspondences) <= 5);
  CHECK(std::abs(planes - report.planar_correspondences) <= 10);
  CHECK(trace.direction_share.sum() > 0.5);
  CHECK(trace.direction_share[0] > 0.0);
  CHECK(trace.degenerate_directions == 0);
  CHECK((trace.T_map_expected.translation() - trace.T_map_level.translation()).norm() < 0.05);
  CHECK(trace.T_map_level.matrix() == report.T_map_sensor.matrix());
}

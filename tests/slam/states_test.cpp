// The states from scan to scan: starting, tracking, lost, searching.

#include <Eigen/Cholesky>

#include "hqslam/slam/options.h"
#include "hqslam/slam/saved_map.h"
#include "hqslam/slam/scan_trace.h"
#include "hqslam/slam/slam.h"
#include "slam/village.h"

using namespace hqslam::slam;

namespace {

const SensorModel kNarrow = small_sensor(16, 240);

/// A hand's, which turns far within a scan.
const SensorModel kSlow = [] {
  SensorModel sensor = small_sensor(32, 512);
  sensor.scan_period_s = 0.5;
  return sensor;
}();

/// A drive along a street of which single scans are others.
class StreetDrive {
 public:
  explicit StreetDrive(Slam slam = Slam(kNarrow)) : slam_(std::move(slam)) {}

  /// 's': in the street; 'f': in it through fog; 'b': blind; 'e': in another street. Out: '-'
  /// starting, 't' tracking, 'l' lost, '?' searching.
  std::string states(const std::string& scans) {
    std::string result;
    for (const char what : scans) {
      OrganizedCloud cloud = (what == 'e' ? elsewhere_ : street_).scan(kNarrow, pose());
      if (what == 'f') add_fog(cloud);
      if (what == 'b') cloud = OrganizedCloud(cloud.rows, cloud.columns);
      report = slam_.process(cloud, 0.1 * scans_++, &trace);
      result += trace.state == "starting"    ? '-'
                : trace.state == "searching" ? '?'
                                             : trace.state.front();
    }
    return result;
  }
  Slam& slam() { return slam_; }

  ScanReport report;
  ScanTrace trace;

 private:
  /// Every fourth return is an echo at 1 to 4 m, and as many are lost, at random.
  void add_fog(OrganizedCloud& cloud) {
    for (std::size_t pixel = 0; pixel < cloud.range_m.size(); ++pixel) {
      const auto number = static_cast<float>(fog_() % 10000);
      if (number >= 5000.0F || !(cloud.range_m[pixel] > 0.0F)) continue;
      const float range_m = number < 2500.0F ? 1.0F + number / 833.0F : 0.0F;
      cloud.points_m[pixel] *= range_m / cloud.range_m[pixel];
      cloud.range_m[pixel] = range_m;
    }
  }
  Pose pose() const { return yard_pose(0.3 * scans_, 0.0, 0.0); }

  Slam slam_;
  Village street_ = street(31);
  Village elsewhere_ = street(77);
  std::mt19937 fog_{7};
  int scans_ = 0;
};

}  // namespace

TEST_CASE("SLAM starts with the first scan that has enough features") {
  StreetDrive drive;
  CHECK(drive.states("bb") == "--");
  CHECK(drive.trace.state_before == "starting");
  CHECK(drive.report.mapping_status == Status::kTooFewFeatures);
  CHECK(drive.states("s") == "t");
  CHECK(drive.report.keyframe);
}

TEST_CASE("up to five scans that miss the map are bridged, blind or of another place") {
  for (const std::string missed : {"b", "bbbbb", "e", "eeeee", "beebe"}) {
    CAPTURE(missed);
    StreetDrive drive;
    drive.states("ssssssss");
    CHECK(drive.states(missed) == std::string(missed.size(), 'l'));
    CHECK(drive.states("sss") == "ttt");
    CHECK(drive.slam().segment_of_scan().back() == 0);
  }
}

TEST_CASE("the sixth missed scan ends tracking: the next one with features begins a segment") {
  StreetDrive drive;
  drive.states("ssssss");
  CHECK(drive.states("eeeee") == "lllll");
  CHECK(drive.states("e") == "t");
  CHECK(drive.report.keyframe);
  CHECK(drive.slam().segment_of_scan() ==
        std::vector<std::size_t>{0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1});
  StreetDrive blind;
  blind.states("ssssss");
  CHECK(blind.states("bbbbbbbb") == "llllllll");  // nothing to begin with
  CHECK(blind.slam().segment_of_scan().back() == 0);
}

TEST_CASE("the uncertainty of a map that went on by odometry alone stays in later poses") {
  SlamOptions options;
  options.mapping.min_correspondences = 1000;  // which the first of these places does not have
  const SensorModel sensor = small_sensor(16, 512);
  Village place = street(31);
  Slam slam(sensor, options);
  ScanReport report;
  double lost_m2 = 0.0;
  for (int i = 0; i < 40; ++i) {
    if (i == 12) place.add_street(-40.0, 0.0, 160.0, 5);
    const Pose pose = yard_pose(0.3 * i, 0.0, 0.0);
    report = slam.process(place.scan(sensor, pose), 0.1 * i);
    if (report.mapping_status == Status::kTooFewFeatures) lost_m2 = report.covariance(0, 0);
  }
  CHECK(is_registered(report.mapping_status));
  CHECK(lost_m2 > 0.01);
  CHECK(report.covariance(0, 0) >= 0.9 * lost_m2);
  CHECK(slam.segment_of_scan().back() == 0);
}

TEST_CASE("in a given map a sensor is searched until found, and again after tracking is lost") {
  StreetDrive mapped;
  mapped.states(std::string(120, 's'));
  mapped.slam().finish();
  StreetDrive drive(Slam(kNarrow, SlamOptions(), mapped.slam().saved_map()));
  CHECK(drive.states("eb") == "??");
  CHECK(drive.states("ss") == "tt");
  CHECK(drive.states("bbbbbb") == "lllll?");
  CHECK(drive.report.mapping_status == Status::kTooFewFeatures);
  CHECK(drive.states("b") == "?");
  CHECK(drive.report.mapping_status == Status::kNotRecognized);
  CHECK(drive.states("ss") == "tt");
}

TEST_CASE("a street is followed through fog, whose scans are told from those of clear air") {
  StreetDrive drive;
  drive.states("ssss");
  CHECK(drive.report.scattered == 0);
  drive.states("ffffffffffffffff");
  CHECK(drive.report.scattered > 0);
  CHECK(drive.report.mapping_status == Status::kOk);
  CHECK((drive.report.T_map_sensor.translation() - Eigen::Vector3d(0.3 * 19, 0.0, 0.0)).norm() <
        0.1);
}

TEST_CASE("a sensor that stands keeps its pose when the place changes around it") {
  const SensorModel sensor = small_sensor(64, 1024);
  const Pose standing = yard_pose(0.0, 0.0, 0.0);
  Slam slam(sensor);
  const OrganizedCloud in_street = street(31).scan(sensor, standing);
  Village cabin;
  cabin.add_box({1.2, -1.3}, {1.5, 1.3}, 3.0);
  cabin.add_box({-1.5, -1.3}, {-1.2, 1.3}, 3.0);
  cabin.add_box({-1.5, 1.1}, {1.5, 1.3}, 3.0);
  cabin.add_box({-1.5, -1.3}, {1.5, -1.1}, 3.0);
  const OrganizedCloud in_cabin = cabin.scan(sensor, standing);
  double farthest_m = 0.0;  // in the plane: four walls do not determine the height
  for (int i = 0; i < 40; ++i) {
    const ScanReport report = slam.process(i < 10 || i >= 30 ? in_street : in_cabin, 0.1 * i);
    farthest_m = std::max(farthest_m, report.T_map_sensor.translation().head<2>().norm());
    CAPTURE(i);
    CHECK(Eigen::LDLT<Eigen::Matrix<double, 6, 6>>(report.covariance).isPositive());
  }
  CHECK(farthest_m < 0.05);
}

TEST_CASE("a sensor that stands makes a keyframe where the place has changed, and no other") {
  Slam slam(kNarrow);
  const Pose standing = yard_pose(0.0, 0.0, 0.0);
  Village place = street(31);
  const OrganizedCloud before = place.scan(kNarrow, standing);
  place.add_box({-2.0, 2.0}, {3.0, 2.5}, 3.0);  // lorries on both sides
  place.add_box({-2.0, -2.5}, {3.0, -2.0}, 3.0);
  const OrganizedCloud after = place.scan(kNarrow, standing);
  std::string keyframes;
  for (int i = 0; i < 30; ++i) {
    keyframes += slam.process(i < 15 ? before : after, 0.1 * i).keyframe ? 'k' : '.';
  }
  CHECK(keyframes == "k..............k..............");
}

TEST_CASE("a trace has each feature with its match, and asking for it changes nothing") {
  Slam plain(kNarrow);
  StreetDrive drive;
  const Village village = street(31);
  for (int i = 0; i < 8; ++i) {
    const auto report = plain.process(village.scan(kNarrow, yard_pose(0.3 * i, 0.0, 0.0)), 0.1 * i);
    drive.states("s");
    CHECK(report.T_map_sensor.matrix() == drive.report.T_map_sensor.matrix());
    CHECK(report.covariance == drive.report.covariance);
  }
  const ScanTrace& trace = drive.trace;
  const ScanReport& report = drive.report;
  CHECK(trace.pixel_class.size() == trace.cloud.range_m.size());
  CHECK(std::ranges::count(trace.pixel_class, PixelClass::kGround) == report.ground_points);
  CHECK(std::ranges::count(trace.pixel_class, PixelClass::kNoReturn) + report.returns ==
        std::ssize(trace.pixel_class));
  int edges = 0;
  int planes = 0;
  for (const TracedFeature& feature : trace.features) {
    const std::size_t pixel = trace.cloud.index(feature.row, feature.column);
    CHECK((trace.cloud.points_m[pixel] - feature.point_m).norm() < 1.0);
    if (!feature.is_matched) continue;
    const bool is_line = feature.kind == FeatureKind::kEdge || feature.kind == FeatureKind::kPost;
    ++(is_line ? edges : planes);
    CHECK(feature.weight_per_m > 0.0);
    const Eigen::Vector3d on_scan_m = trace.T_map_level * feature.point_m.cast<double>();
    if (!is_line) {
      // On the ground only the vertical component counts, which is a little less.
      CHECK((feature.on_map_m.cast<double>() - on_scan_m).norm() < feature.residual_m + 1e-3);
    }
  }
  // The last search was made where the last but one step led.
  CHECK(std::abs(edges - report.edge_correspondences) <= 5);
  CHECK(std::abs(planes - report.planar_correspondences) <= 10);
  CHECK(trace.direction_share.sum() > 0.5);
  CHECK(trace.T_map_level.matrix() == report.T_map_sensor.matrix());
}

TEST_CASE("a hand that turns by 30 degrees a scan and jerks back by 60 is followed") {
  const Yard room{.half_length_m = 10.0, .half_width_m = 6.0};
  const auto pose = [](int scan) {
    const int ahead = std::min(scan, 7);
    const int back = scan - ahead;
    return yard_pose(-3.0 + ahead - 0.3 * back, 0.0, (-30.0 * ahead + 60.0 * back) * kDegree_rad);
  };
  Slam slam(kSlow);
  for (int scan = 0; scan < 9; ++scan) slam.process(room.scan(kSlow, pose(scan)), 0.5 * scan);
  const Pose error = (pose(0).inverse() * pose(8)).inverse() * slam.trajectory()[8].T_map_sensor;
  CHECK(error.translation().norm() < 0.05);
  CHECK(rotation_angle_rad(error) < 0.01);
}

TEST_CASE("a hand in a room that half fits is of uncertain place, and not located in a given map") {
  const Yard room{.half_length_m = 10.0, .half_width_m = 6.0};
  const Yard other{.half_length_m = 10.3, .half_width_m = 7.0};
  const auto pose = [](int scan) { return yard_pose(-3.0 + 0.3 * scan, 0.0, 0.1 * (scan % 3)); };
  const auto walk = [&](Slam& slam) {
    for (int scan = 0; scan < 8; ++scan) {
      CHECK(is_registered(slam.process(room.scan(kSlow, pose(scan)), 0.5 * scan).mapping_status));
    }
  };
  Slam alone(kSlow);
  walk(alone);
  Slam in_map(kSlow, {}, alone.saved_map());
  const ScanReport found = alone.process(other.scan(kSlow, pose(8)), 4.0);
  CHECK(found.mapping_status == Status::kDegenerate);
  const Pose error = (pose(0).inverse() * pose(8)).inverse() * found.T_map_sensor;
  CHECK(error.translation().norm() > 0.5);
  CHECK(std::sqrt(found.covariance.diagonal().head<2>().minCoeff()) > error.translation().norm());
  walk(in_map);
  CHECK_FALSE(is_registered(in_map.process(other.scan(kSlow, pose(8)), 4.0).mapping_status));
}

TEST_CASE("along a corridor the rings on its ceiling do not hold a sensor that starts slowly") {
  const Yard corridor{.half_width_m = 1.4, .pillars = false, .ceiling_m = 3.0};
  const SensorModel sensor = small_sensor(16, 1024);
  Slam slam(sensor);
  for (int scan = 0; scan < 8; ++scan) {
    const double x_m = 0.005 * scan * scan;
    const auto cloud = corridor.scan(sensor, yard_pose(-21.0 + x_m, 0.0, 0.0));
    const Pose found = slam.process(cloud, 0.1 * scan).T_map_sensor;
    CHECK(std::abs(found.translation().x() - x_m) < 0.03);
  }
}

TEST_CASE("which quarter turn a hand made in a square room is not said to be known") {
  const Yard room{.half_length_m = 6.0, .half_width_m = 6.0, .pillars = false};
  for (const double turn_rad : {45.0 * kDegree_rad, -45.0 * kDegree_rad}) {
    Slam slam(kSlow);
    for (int scan = 0; scan < 6; ++scan) {
      slam.process(room.scan(kSlow, yard_pose(0.3 * scan, 0.0, 0.0)), 0.5 * scan);
    }
    const auto report = slam.process(room.scan(kSlow, yard_pose(1.8, 0.0, turn_rad)), 3.0);
    CHECK(report.mapping_status == Status::kDegenerate);
    CHECK(std::sqrt(report.covariance(5, 5)) > 10.0 * kDegree_rad);
  }
}

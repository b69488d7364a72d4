// After tracking is lost the path continues in a submap of its own, and submaps are joined where a
// place is recognized.

#include "hqslam/slam/options.h"
#include "hqslam/slam/slam.h"
#include "slam/village.h"
#include "slam/yard_drive.h"

using namespace hqslam::slam;

namespace {

struct Driven {
  std::vector<Pose> T_street_sensor;
  std::vector<ScanReport> reports;
  std::vector<LoopReport> last_reports;
  std::vector<Pose> T_map_sensor;
  std::vector<std::size_t> submap_of_scan;
  std::vector<std::size_t> segment_of_scan;
  std::size_t map_points = 0;
  std::array<std::size_t, 2> map_points_of_submap{};
};

/// Steps of a metre along the street from x_m on, up or down.
std::vector<Pose> steps(double x_m, double y_m, int count, bool up) {
  std::vector<Pose> result;
  for (int i = 0; i < count; ++i) {
    result.push_back(yard_pose(x_m + (up ? i : -i) * kStreetStep_m, y_m, up ? 0.0 : M_PI));
  }
  return result;
}

/// Drives through one village, and is then carried to the begin of the second path.
Driven drive(const Village& village, const std::vector<Pose>& path, const Village& other_village,
             const std::vector<Pose>& other_path) {
  Slam slam(street_sensor());
  Driven driven;
  const auto process = [&](const Village& where, const Pose& T_street_sensor) {
    driven.T_street_sensor.push_back(T_street_sensor);
    driven.reports.push_back(slam.process(where.scan(T_street_sensor),
                                          0.1 * static_cast<double>(driven.reports.size())));
  };
  for (const Pose& T_street_sensor : path) process(village, T_street_sensor);
  for (const Pose& T_street_sensor : other_path) process(other_village, T_street_sensor);
  driven.last_reports = slam.finish();
  driven.T_map_sensor = poses_of(slam.trajectory());
  driven.submap_of_scan = slam.submap_of_scan();
  driven.segment_of_scan = slam.segment_of_scan();
  driven.map_points = slam.map_points_m().size();
  for (const std::size_t submap : {std::size_t{0}, std::size_t{1}}) {
    driven.map_points_of_submap[submap] = slam.map_points_m(submap).size();
  }
  return driven;
}

/// Shortens half of the returns, by one share for ten neighbours, so that the scan fits less well
/// than the last one.
void add_clutter(OrganizedCloud& cloud) {
  std::mt19937 generator(1);
  float share = 1.0F;
  for (std::size_t i = 0; i < cloud.range_m.size(); ++i) {
    if (i % 10 == 0) share = std::min(static_cast<float>(generator() % 2000) / 1000.0F, 1.0F);
    cloud.range_m[i] *= share;
    cloud.points_m[i] *= share;
  }
}

}  // namespace

TEST_CASE("a sensor carried to a place passed before, either way, is joined with the path there") {
  const Village village = street(31);
  for (const bool up : {true, false}) {
    CAPTURE(up);
    const std::vector<Pose> other_path = steps(up ? 15.0 : 65.0, 1.0, 50, up);
    const Driven driven = drive(village, steps(0.0, 0.0, 80, true), village, other_path);
    CHECK(std::all_of(driven.submap_of_scan.begin(), driven.submap_of_scan.end() - 40,
                      [](std::size_t submap) { return submap == 0; }));
    CHECK(driven.submap_of_scan.back() == 0);
    CHECK(driven.segment_of_scan[79] == 0);
    CHECK(driven.segment_of_scan.back() == 1);
    // The first scans after it was carried were not located: nothing is known about them.
    CHECK(worst_error_m(driven.T_map_sensor, driven.T_street_sensor, 90) < 0.15);
    const auto status_of = [](const ScanReport& report) { return report.loop.status; };
    CHECK(std::ranges::count(driven.reports, LoopStatus::kClosed, status_of) +
              std::ranges::count(driven.last_reports, LoopStatus::kClosed, &LoopReport::status) ==
          1);
  }
}

TEST_CASE("the map is complete at any time, also just after the sensor was carried") {
  const SensorModel sensor = street_sensor();
  SlamOptions options;
  options.mapping.recent_path_m = 20.0;
  Slam slam(sensor, options);
  std::size_t before = 0;
  int scan = 0;
  for (const unsigned seed : {31U, 77U}) {
    const Village village = street(seed);
    for (const Pose& T_street_sensor : steps(0.0, 0.0, 40, true)) {
      slam.process(village.scan(T_street_sensor), 0.1 * scan);
      const std::size_t points = slam.map_points_m().size();
      CAPTURE(scan++);
      CHECK(points > 0.99 * static_cast<double>(before));
      before = points;
    }
  }
  CHECK(slam.submap_of_scan().back() == 1);
}

TEST_CASE("laps without loop closing let the map grow no further") {
  // Points leave the window after 20 m of path, and are observed again with every lap of 63 m.
  Village village;
  village.add_street(-40.0, -24.0, 80.0, 31);
  village.add_street(-40.0, 24.0, 80.0, 32);
  constexpr int kStepsOfLap = 60;
  const SensorModel sensor = small_sensor(16, 256);
  SlamOptions options;
  options.loop_closing.enabled = false;
  options.mapping.recent_path_m = 20.0;
  Slam slam(sensor, options);
  std::vector<double> points_after_lap;
  for (int i = 0; i < 6 * kStepsOfLap; ++i) {
    const double angle_rad = 2.0 * std::numbers::pi * i / kStepsOfLap;
    const Pose T_village_sensor = yard_pose(10.0 * std::cos(angle_rad), 10.0 * std::sin(angle_rad),
                                            angle_rad + std::numbers::pi / 2.0);
    slam.process(village.scan(sensor, T_village_sensor), 0.1 * i);
    if ((i + 1) % kStepsOfLap == 0) {
      points_after_lap.push_back(static_cast<double>(slam.map_points_m().size()));
    }
  }
  CHECK(points_after_lap[0] > 1000);
  CHECK(points_after_lap[5] < 1.1 * points_after_lap[1]);
  CHECK(slam.submap_of_scan().back() == 0);
}

TEST_CASE("a sensor carried to a new place is tracked there, in a submap and a map of its own") {
  const Driven driven =
      drive(street(31), steps(0.0, 0.0, 80, true), street(77), steps(0.0, 0.0, 50, true));
  CHECK(driven.submap_of_scan[79] == 0);
  CHECK(driven.submap_of_scan.back() == 1);
  const Pose step = driven.T_map_sensor[100].inverse() * driven.T_map_sensor[129];
  CHECK(step.translation().norm() == doctest::Approx(29.0).epsilon(0.01));
  CHECK(driven.reports.back().mapping_status == Status::kOk);
  CHECK(driven.map_points == driven.map_points_of_submap[0] + driven.map_points_of_submap[1]);
  CHECK(driven.map_points_of_submap[0] > 1000);
  CHECK(driven.map_points_of_submap[1] > 1000);
}

TEST_CASE(
    "a sensor moved by a metre between two scans is uncertain by as much until it is located") {
  constexpr int kMoved = 20;
  const Village village = street(31);
  for (const double aside_m : {1.0, -1.0}) {
    CAPTURE(aside_m);
    Slam slam(street_sensor());
    std::vector<Pose> T_street_sensor;
    ScanReport moved;
    for (int i = 0; i < kMoved + 5; ++i) {
      T_street_sensor.push_back(yard_pose(i, i < kMoved ? 0.0 : aside_m, 0.0));
      OrganizedCloud cloud = village.scan(T_street_sensor.back());
      if (i == kMoved) add_clutter(cloud);
      const ScanReport report = slam.process(cloud, 0.1 * i);
      if (i == kMoved) moved = report;
      if (i > kMoved) CHECK(report.mapping_status == Status::kOk);
    }
    CHECK(moved.mapping_status == Status::kTooFewFeatures);
    CHECK(std::sqrt(moved.covariance(1, 1)) > 0.5);
    CHECK(worst_error_m(poses_of(slam.trajectory()), T_street_sensor, kMoved + 1) < 0.05);
  }
}

TEST_CASE("a sensor that is covered and carried elsewhere continues in a submap of its own") {
  const SensorModel sensor = street_sensor();
  Slam slam(sensor);
  int scans = 0;
  const auto process = [&](const OrganizedCloud& cloud) {
    return slam.process(cloud, 0.1 * scans++);
  };
  const Village village = street(31);
  for (const Pose& T_street_sensor : steps(0.0, 0.0, 10, true)) {
    process(village.scan(T_street_sensor));
  }
  const OrganizedCloud standing = village.scan(yard_pose(9.0, 0.0, 0.0));
  for (int i = 0; i < 10; ++i) process(standing);
  for (int i = 0; i < 20; ++i) process(OrganizedCloud(sensor.rows(), sensor.columns));
  const std::size_t points_before = slam.map_points_m().size();
  const OrganizedCloud there = Yard{.pillars = false}.scan(sensor, yard_pose(5.0, 3.0, 1.0));
  const ScanReport first = process(there);
  const Pose T_standing_there = slam.trajectory()[19].T_map_sensor.inverse() * first.T_map_sensor;
  CHECK(T_standing_there.translation().norm() < 0.1);  // the motion is unknown
  CHECK(first.keyframe);
  for (int i = 0; i < 5; ++i) CHECK(process(there).mapping_status == Status::kOk);
  CHECK(slam.map_points_m().size() > points_before);
  CHECK(slam.submap_of_scan()[19] == 0);
  CHECK(slam.submap_of_scan().back() == 1);
  CHECK(slam.saved_map().places.size() < 4);  // of the street alone
}

TEST_CASE("a map that was continued before a scan was registered in it loses nothing when one is") {
  // Features within 15 m are too few for this map, not for the odometry.
  const SensorModel sensor = small_sensor(16, 1024);
  SlamOptions options;
  options.mapping.min_correspondences = 1000;
  Slam slam(sensor, options);
  std::size_t points_before = 0;
  for (int i = 0; i < 14; ++i) {
    OrganizedCloud scan = drive_scan(sensor, i);
    for (float& range_m : scan.range_m) {
      if (i < 8 && range_m > 15.0F) range_m = 0.0F;
    }
    const ScanReport report = slam.process(scan, i * kDrivePeriod_s);
    const std::size_t points = slam.map_points_m().size();
    CAPTURE(i);
    if (i == 7) CHECK(report.keyframe);
    if (i >= 1) CHECK(is_registered(report.mapping_status) == (i >= 9));
    CHECK(points > 0.99 * static_cast<double>(points_before));
    points_before = points;
  }
  CHECK(slam.submap_of_scan().back() == 0);
}

TEST_CASE("scans on a continued map stay with it when tracking is lost after them") {
  const SensorModel sensor = small_sensor(16, 1024);
  SlamOptions options;
  options.mapping.min_correspondences = 1000;
  Slam slam(sensor, options);
  for (int i = 0; i < 14; ++i) {
    OrganizedCloud scan = drive_scan(sensor, i);
    for (float& range_m : scan.range_m) {
      if (range_m > 15.0F || (i >= 8 && i < 13)) range_m = 0.0F;
    }
    const ScanReport report = slam.process(scan, i * kDrivePeriod_s);
    if (i == 7 || i == 13) CHECK(report.keyframe);
  }
  CHECK(slam.segment_of_scan() ==
        std::vector<std::size_t>{0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1});
}

TEST_CASE("unmeasured motion is not counted twice where a submap begins") {
  const SensorModel sensor = street_sensor();
  const Village village = street(31);
  Slam slam(sensor);
  double before_m2 = 0.0;
  int scan = 0;
  for (const Pose& pose : steps(0.0, 0.0, 80, true)) {
    const bool blind = scan >= 40 && scan < 70;
    const ScanReport report = slam.process(
        blind ? OrganizedCloud(sensor.rows(), sensor.columns) : village.scan(pose), 0.1 * scan++);
    const double now_m2 = report.covariance.topLeftCorner<3, 3>().trace();
    if (scan == 71) CHECK(report.keyframe);
    if (scan == 71) CHECK(now_m2 < 1.3 * before_m2);
    before_m2 = now_m2;
  }
  CHECK(slam.submap_of_scan().back() == 1);
}

TEST_CASE("a covariance keeps unmeasured motion until a loop removes it") {
  const SensorModel sensor = street_sensor();
  const Village village = street(31);
  for (const bool blind : {true, false}) {
    CAPTURE(blind);
    Slam slam(sensor);
    std::vector<Pose> T_street_sensor;
    std::vector<ScanReport> reports;
    const auto process = [&](const OrganizedCloud& cloud, const Pose& pose) {
      T_street_sensor.push_back(pose);
      reports.push_back(slam.process(cloud, 0.1 * static_cast<double>(reports.size())));
    };
    for (const Pose& pose : steps(0.0, 0.0, 80, true)) process(village.scan(pose), pose);
    // Back to a place passed before, blind for six seconds or from one scan to the next.
    for (int i = 0; blind && i < 60; ++i) {
      process(OrganizedCloud(sensor.rows(), sensor.columns), T_street_sensor.back());
    }
    const std::size_t seen_again = reports.size();
    for (const Pose& pose : steps(15.0, 1.0, 50, true)) process(village.scan(pose), pose);
    slam.finish();
    CHECK(slam.submap_of_scan().back() == 0);
    const auto sigma_m = [](const Eigen::Matrix<double, 6, 6>& covariance) {
      return std::sqrt(covariance.topLeftCorner<3, 3>().trace());
    };
    const auto truth = [&](std::size_t i) {
      return Pose(T_street_sensor.front().inverse() * T_street_sensor[i]);
    };
    bool is_joined = false;
    for (std::size_t i = seen_again + 7; i < reports.size(); ++i) {
      CAPTURE(i);
      is_joined = is_joined || reports[i].loop.status == LoopStatus::kClosed;
      const auto error_m = (reports[i].T_map_sensor.translation() - truth(i).translation()).norm();
      CHECK(error_m < 3.0 * sigma_m(reports[i].covariance) + 0.05);
      CHECK(std::isfinite(reports[i].covariance.trace()) == (blind || is_joined));
      if (!is_joined) CHECK(sigma_m(reports[i].covariance) > 10.0);
      if (is_joined) CHECK(sigma_m(reports[i].covariance) < 1.0);
    }
    const auto corrected = slam.corrected_covariances();
    for (const auto& [scan, covariance] : corrected) {
      const std::size_t corrected_scan = scan;
      CAPTURE(corrected_scan);
      CHECK(scan >= seen_again);
      if (!std::isfinite(covariance.trace())) {
        CHECK(scan < seen_again + 6);  // before it was noticed
        continue;
      }
      const double error_m =
          (slam.trajectory()[scan].T_map_sensor.translation() - truth(scan).translation()).norm();
      CHECK(error_m < 3.0 * sigma_m(covariance) + 0.05);
      CHECK(sigma_m(covariance) < 1.0);
    }
    // Scans before the loop are known afterwards, those after it at once.
    std::map<std::size_t, Covariance> finally(corrected.begin(), corrected.end());
    for (std::size_t i = seen_again; i < reports.size(); ++i) {
      finally.try_emplace(i, reports[i].covariance);
    }
    const auto is_known = [&](const auto& of_scan) { return sigma_m(of_scan.second) < 1.0; };
    CHECK(std::ranges::count_if(finally, is_known) >= 40);  // of 50 scans
  }
}

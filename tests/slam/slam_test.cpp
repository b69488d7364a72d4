#include "hqslam/slam/slam.h"

#include <doctest/doctest.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "error_message.h"
#include "hqslam/core/error.h"
#include "hqslam/slam/options.h"
#include "slam/steady_drive.h"
#include "slam/village.h"
#include "slam/yard.h"

using namespace hqslam;
using slam::Status;

namespace {

constexpr double kPeriod_s = 0.1;

/// Around the yard at 5 m/s, with turns: the true pose at a time.
Pose drive_pose(double time_s) {
  const double phase = 0.25 * time_s;
  const Eigen::Vector2d p(14.0 * std::sin(phase), 3.0 * std::sin(2.0 * phase));
  const Eigen::Vector2d v(14.0 * std::cos(phase), 6.0 * std::cos(2.0 * phase));
  return test::yard_pose(p.x(), p.y(), std::atan2(v.y(), v.x()));
}

/// Scan `i` of the drive, captured rolling.
OrganizedCloud drive_scan(const SensorModel& sensor, int i) {
  return test::Yard().rolling_scan(
      sensor, [&](double time_s) { return drive_pose(i * kPeriod_s + time_s); });
}

double worst_error_m(const Trajectory& trajectory) {
  double worst_m = 0.0;
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    const Pose truth = drive_pose(0).inverse() * drive_pose(static_cast<double>(i) * kPeriod_s);
    worst_m =
        std::max(worst_m, (trajectory[i].T_map_sensor.translation() - truth.translation()).norm());
  }
  return worst_m;
}

/// A scan of a sensor whose calibration is off so that straight walls look bent: every metre driven
/// then turns the estimate a little.
OrganizedCloud bent(OrganizedCloud cloud) {
  constexpr float kBend_per_m = 0.0002F;
  for (std::size_t i = 0; i < cloud.range_m.size(); ++i) {
    if (cloud.range_m[i] == 0.0F) continue;
    Eigen::Vector3f& point_m = cloud.points_m[i];
    point_m.y() += kBend_per_m * point_m.x() * point_m.x();
    cloud.range_m[i] = point_m.norm();
  }
  return cloud;
}

/// What became of a drive once around a block and on.
struct ClosedDrive {
  Trajectory trajectory;
  std::vector<slam::ScanReport> reports;
  std::vector<Eigen::Vector3f> map_points_m;
};

ClosedDrive drive_around(const SensorModel& sensor, const std::vector<OrganizedCloud>& scans) {
  slam::SlamOptions options;
  options.mapping.recent_path_m = 50.0;
  slam::Slam slam(sensor, options);
  ClosedDrive result;
  for (const OrganizedCloud& scan : scans) {
    result.reports.push_back(
        slam.process(scan, kPeriod_s * static_cast<double>(result.reports.size())));
  }
  slam.finish();
  result.trajectory = slam.trajectory();
  result.map_points_m = slam.map_points_m();
  return result;
}

/// How far the end of the way is from where it was passed first, beyond what is true.
double closing_error_m(const ClosedDrive& drive, const test::Circuit& circuit) {
  const std::size_t last = drive.trajectory.size() - 1;
  const Eigen::Vector3d end_m = circuit.T_village_sensor[last].translation();
  std::size_t nearest = 0;
  for (std::size_t i = 0; i < last / 2; ++i) {
    const auto distance_m = [&](std::size_t k) {
      return (circuit.T_village_sensor[k].translation() - end_m).norm();
    };
    if (distance_m(i) < distance_m(nearest)) nearest = i;
  }
  const Pose T_true = circuit.T_village_sensor[nearest].inverse() * circuit.T_village_sensor[last];
  const Pose T_estimated =
      drive.trajectory[nearest].T_map_sensor.inverse() * drive.trajectory[last].T_map_sensor;
  return (T_estimated.translation() - T_true.translation()).norm();
}

/// The drive around the yard with stamps of another clock: its worst error, and how often the map
/// did not tell the pose.
struct ClockedDrive {
  double worst_error_m = 0.0;
  int not_ok = 0;
};

template <typename StampOf>
ClockedDrive drive_with_clock(const StampOf& stamp_s) {
  const SensorModel sensor = test::small_sensor(16, 512);
  slam::Slam slam(sensor);
  ClockedDrive result;
  for (int i = 0; i < 30; ++i) {
    const auto report = slam.process(drive_scan(sensor, i), stamp_s(i));
    CHECK(report.stamp_s == stamp_s(i));
    result.not_ok += report.mapping_status != Status::kOk;
  }
  result.worst_error_m = worst_error_m(slam.trajectory());
  return result;
}

OrganizedCloud garbage(const SensorModel& sensor, unsigned seed) {
  std::mt19937 generator(seed);
  RangeImage image(sensor.rows(), sensor.columns);
  for (float& range_m : image.range_m)
    range_m = 1.0F + 0.05F * static_cast<float>(generator() % 1000);
  return unproject(image, sensor, CaptureTime::kMotionCorrected);
}

}  // namespace

TEST_CASE("a sensor of sixteen rows that stands is located in every scan, and stays where it is") {
  const SensorModel sensor = test::small_sensor(16, 1024);
  std::mt19937 generator(1);
  const auto noisy = [&](OrganizedCloud cloud) {
    for (std::size_t i = 0; i < cloud.range_m.size(); ++i) {
      if (cloud.range_m[i] <= 0.0F) continue;
      const float factor = 1.0F + 0.03F *
                                      (static_cast<float>(generator() % 2001) / 1000.0F - 1.0F) /
                                      cloud.range_m[i];
      cloud.range_m[i] *= factor;
      cloud.points_m[i] *= factor;
    }
    return cloud;
  };
  slam::Slam slam(sensor);
  for (int i = 0; i < 20; ++i) {
    const OrganizedCloud scan = test::Yard().scan(sensor, test::yard_pose(1.0, 2.0, 0.3));
    const auto report = slam.process(noisy(scan), i * kPeriod_s);
    CAPTURE(i);
    CHECK(report.mapping_status != Status::kTooFewFeatures);
    CHECK(report.T_map_sensor.translation().norm() < 0.02);
    CHECK(rotation_angle_rad(report.T_map_sensor) < 0.002);
  }
}

TEST_CASE("a drive around a yard is tracked to centimetres with 16, 32, 64 and 128 rows") {
  for (const int rows : {16, 32, 64, 128}) {
    const SensorModel sensor = test::small_sensor(rows, 512);
    slam::Slam slam(sensor);
    int not_ok = 0;
    for (int i = 0; i < 40; ++i) {
      not_ok += slam.process(drive_scan(sensor, i), i * kPeriod_s).mapping_status != Status::kOk;
    }
    CAPTURE(rows);
    CHECK(not_ok <= 4);
    CHECK(worst_error_m(slam.trajectory()) < 0.15);
  }
}

TEST_CASE("one and two threads give the same bytes, and so do two runs") {
  const SensorModel sensor = test::small_sensor(16, 512);
  std::vector<Trajectory> trajectories;
  std::vector<std::vector<Eigen::Vector3f>> maps;
  const int threads_before = omp_get_max_threads();
  for (const int threads : {1, 2, 2}) {
    omp_set_num_threads(threads);
    slam::Slam slam(sensor);
    for (int i = 0; i < 20; ++i) slam.process(drive_scan(sensor, i), i * kPeriod_s);
    trajectories.push_back(slam.trajectory());
    maps.push_back(slam.map_points_m());
  }
  omp_set_num_threads(threads_before);
  for (int run = 1; run < 3; ++run) {
    CHECK(maps[run] == maps[0]);
    for (std::size_t i = 0; i < trajectories[0].size(); ++i) {
      CHECK(trajectories[run][i].T_map_sensor.matrix() == trajectories[0][i].T_map_sensor.matrix());
    }
  }
}

TEST_CASE("empty, nearly empty and garbage scans are survived, reported and recovered from") {
  const SensorModel sensor = test::small_sensor(32, 512);
  for (const int kind : {0, 1, 2}) {
    slam::Slam slam(sensor);
    for (int i = 0; i < 40; ++i) {
      OrganizedCloud cloud = drive_scan(sensor, i);
      const bool bad = i >= 20 && i < 23;
      if (bad && kind == 0) cloud = OrganizedCloud(sensor.rows(), sensor.columns);
      if (bad && kind == 1) {
        for (std::size_t k = 0; k < cloud.range_m.size(); ++k) {
          if (k % 500 != 0) cloud.range_m[k] = 0.0F;
        }
      }
      if (bad && kind == 2) cloud = garbage(sensor, static_cast<unsigned>(i));
      const auto report = slam.process(cloud, i * kPeriod_s);
      CAPTURE(kind);
      CAPTURE(i);
      if (bad) CHECK(report.mapping_status != Status::kOk);
      if (bad) CHECK(!report.key_frame);
      if (i >= 26) CHECK(report.mapping_status == Status::kOk);
    }
    CAPTURE(kind);
    CHECK(slam.trajectory().size() == 40);
    CHECK(worst_error_m(slam.trajectory()) < 0.3);
    const Pose end = slam.trajectory().back().T_map_sensor;
    const Pose truth = drive_pose(0).inverse() * drive_pose(3.9);
    CHECK((end.translation() - truth.translation()).norm() < 0.15);
  }
}

TEST_CASE("a drive that begins with empty scans begins where the first good scan is") {
  const SensorModel sensor = test::small_sensor(16, 512);
  slam::Slam slam(sensor);
  const OrganizedCloud empty(sensor.rows(), sensor.columns);
  CHECK(slam.process(empty, 0.0).mapping_status == Status::kTooFewFeatures);
  CHECK(slam.process(empty, 0.1).mapping_status == Status::kTooFewFeatures);
  CHECK(slam.process(drive_scan(sensor, 2), 0.2).mapping_status == Status::kOk);
  CHECK(slam.process(drive_scan(sensor, 3), 0.3).mapping_status == Status::kOk);
  CHECK(slam.map_points_m().size() > 100);
}

TEST_CASE("a sensor that is carried to another place starts the map anew there") {
  const SensorModel sensor = test::small_sensor(32, 512);
  test::Yard elsewhere;
  elsewhere.half_length_m = 13.0;
  elsewhere.half_width_m = 41.0;
  slam::Slam slam(sensor);
  int ok_elsewhere = 0;
  for (int i = 0; i < 50; ++i) {
    const auto report =
        slam.process(i < 15 ? drive_scan(sensor, i)
                            : elsewhere.scan(sensor, test::yard_pose(0.3, -20.0 + 0.5 * i, 1.5)),
                     i * kPeriod_s);
    CHECK(report.T_map_sensor.matrix().allFinite());
    if (i >= 40) ok_elsewhere += report.mapping_status == Status::kOk;
  }
  CHECK(ok_elsewhere >= 8);
  // The last steps are those driven: 0.5 m each.
  const Trajectory& trajectory = slam.trajectory();
  const Pose step = trajectory[48].T_map_sensor.inverse() * trajectory[49].T_map_sensor;
  CHECK(step.translation().norm() == doctest::Approx(0.5).epsilon(0.1));
}

TEST_CASE("a drive is tracked to centimetres whatever the clock does") {
  const ClockedDrive equal_or_falling = drive_with_clock([](int i) { return i < 15 ? 1.0 : 0.5; });
  CHECK(equal_or_falling.worst_error_m < 0.15);
  CHECK(equal_or_falling.not_ok <= 4);
  // Every fifth scan is stamped right after the one before.
  const ClockedDrive late =
      drive_with_clock([](int i) { return kPeriod_s * i - (i % 5 == 4 ? 0.0999 : 0.0); });
  CHECK(late.worst_error_m < 0.15);
  CHECK(late.not_ok <= 4);
  // From the time since the start to that of day, and back.
  const ClockedDrive set_twice =
      drive_with_clock([](int i) { return kPeriod_s * i + (i >= 10 && i < 20 ? 1.7e9 : 0.0); });
  CHECK(set_twice.worst_error_m < 0.15);
  CHECK(set_twice.not_ok <= 4);
}

TEST_CASE("a stamp that is no time in seconds is refused, and nothing has changed") {
  const SensorModel sensor = test::small_sensor(16, 512);
  slam::Slam slam(sensor);
  for (int i = 0; i < 6; ++i) {
    const OrganizedCloud scan = drive_scan(sensor, i);
    for (const double stamp : {std::nan(""), HUGE_VAL, -HUGE_VAL, 1.7e18}) {
      CHECK_THROWS_AS(slam.process(scan, stamp), Error);
    }
    slam.process(scan, i * kPeriod_s);
  }
  CHECK(slam.trajectory().size() == 6);
  CHECK(worst_error_m(slam.trajectory()) < 0.15);
}

TEST_CASE("a sensor that is covered is believed to go on for a second, then less and less") {
  const SensorModel sensor = test::small_sensor(16, 512);
  slam::Slam slam(sensor);
  slam::ScanReport report;
  for (int i = 0; i < 10; ++i) report = slam.process(drive_scan(sensor, i), i * kPeriod_s);
  const auto sigma_m = [&] { return std::sqrt(report.covariance.topLeftCorner<3, 3>().trace()); };
  const double seeing_m = sigma_m();
  double before_m = seeing_m;
  const OrganizedCloud empty(sensor.rows(), sensor.columns);
  for (int i = 10; i < 150; ++i) {
    report = slam.process(empty, i * kPeriod_s);
    CHECK(report.mapping_status == Status::kTooFewFeatures);
    CHECK(sigma_m() > before_m);
    before_m = sigma_m();
  }
  const Trajectory& trajectory = slam.trajectory();
  const auto way_m = [&](std::size_t from, std::size_t to) {
    return (trajectory[to].T_map_sensor.translation() - trajectory[from].T_map_sensor.translation())
        .norm();
  };
  CHECK(way_m(9, 19) > 3.0);
  CHECK(way_m(9, 149) < 12.0);
  CHECK(way_m(99, 149) < 0.1);
  CHECK(seeing_m < 0.1);
  CHECK(before_m > 10.0);
}

TEST_CASE("ten scans that are missing in a row are bridged, and the status says so") {
  const SensorModel sensor = test::small_sensor(16, 512);
  slam::Slam slam(sensor);
  double worst_m = 0.0;
  for (int i = 0; i < 60; ++i) {
    if (i >= 25 && i < 35) continue;
    const auto report = slam.process(drive_scan(sensor, i), i * kPeriod_s);
    CHECK((report.mapping_status == Status::kAfterGap) == (i == 35));
    const Pose truth = drive_pose(0).inverse() * drive_pose(i * kPeriod_s);
    worst_m = std::max(worst_m, (report.T_map_sensor.translation() - truth.translation()).norm());
  }
  CHECK(worst_m < 0.1);
}

TEST_CASE("a steady drive with roll and pitch is tracked from its first scan on") {
  // As in closed form, not as the library believes that sensors move; no start from standstill.
  const test::SteadyDrive drive{test::yard_pose(-10, -4, 0.2), {8.0, 0.3, 0.1}, {0.10, -0.06, 0.5}};
  const test::Yard yard;
  for (const int rows : {16, 64}) {
    const SensorModel sensor = test::small_sensor(rows, 512);
    slam::Slam slam(sensor);
    double worst_m = 0.0;
    double worst_rad = 0.0;
    for (int i = 0; i < 18; ++i) {
      const double stamp_s = i * kPeriod_s;
      const auto report = slam.process(
          yard.rolling_scan(sensor, [&](double time_s) { return drive.at(stamp_s + time_s); }),
          stamp_s);
      const Pose truth = drive.at(0.0).inverse() * drive.at(stamp_s);
      worst_m = std::max(worst_m, (report.T_map_sensor.translation() - truth.translation()).norm());
      worst_rad = std::max(worst_rad, rotation_angle_rad(report.T_map_sensor.inverse() * truth));
    }
    CAPTURE(rows);
    CHECK(worst_m < 0.06);
    CHECK(worst_rad < 0.006);
  }
}

TEST_CASE("a fast sensor that was covered and stands elsewhere then is followed there at once") {
  test::Village street;
  street.add_street(-40.0, 0.0, 240.0, 31);
  test::Village elsewhere;
  elsewhere.add_street(-60.0, 0.0, 120.0, 32);
  const SensorModel sensor = test::small_sensor(16, 360);
  slam::Slam slam(sensor);
  int scans = 0;
  const auto process = [&](const OrganizedCloud& cloud) {
    return slam.process(cloud, kPeriod_s * scans++);
  };
  // Up to 8 m in a scan: farther than odometry and map look for what a scan saw.
  double x_m = 0.0;
  for (int i = 0; i < 20; ++i) {
    x_m += std::min(0.5 * i, 8.0);
    process(street.scan(sensor, test::yard_pose(x_m, 0.0, 0.0)));
  }
  CHECK(slam.trajectory().back().T_map_sensor.translation().x() ==
        doctest::Approx(x_m).epsilon(0.01));
  for (int i = 0; i < 20; ++i) process(OrganizedCloud(sensor.rows(), sensor.columns));
  const OrganizedCloud there = elsewhere.scan(sensor, test::yard_pose(0.0, 0.0, 1.0));
  const Pose T_map_there = process(there).T_map_sensor;
  for (int i = 0; i < 5; ++i) {
    const slam::ScanReport report = process(there);
    CHECK(report.mapping_status == Status::kOk);
    CHECK((T_map_there.inverse() * report.T_map_sensor).translation().norm() < 0.05);
  }
}

TEST_CASE("points and ranges that are not finite do no harm") {
  const SensorModel sensor = test::small_sensor(16, 512);
  slam::Slam slam(sensor);
  for (int i = 0; i < 10; ++i) {
    OrganizedCloud cloud = drive_scan(sensor, i);
    for (std::size_t k = 0; k < cloud.range_m.size(); k += 97) {
      cloud.range_m[k] = k % 2 == 0 ? std::nanf("") : HUGE_VALF;
      cloud.points_m[k].setConstant(std::nanf(""));
    }
    const auto report = slam.process(cloud, i * kPeriod_s);
    CHECK(report.T_map_sensor.matrix().allFinite());
  }
  CHECK(worst_error_m(slam.trajectory()) < 0.15);
}

TEST_CASE("a pixel with a capture time that is not finite is no return") {
  const SensorModel sensor = test::small_sensor(16, 512);
  slam::Slam slam(sensor);
  slam::Slam slam_without(sensor);
  for (int i = 0; i < 10; ++i) {
    OrganizedCloud cloud = drive_scan(sensor, i);
    OrganizedCloud without = cloud;
    for (std::size_t k = 0; k < cloud.range_m.size(); k += 97) {
      cloud.time_offset_s[k] = k % 2 == 0 ? std::nanf("") : HUGE_VALF;
      without.range_m[k] = 0.0F;
    }
    const auto report = slam.process(cloud, i * kPeriod_s);
    const auto expected = slam_without.process(without, i * kPeriod_s);
    CHECK(report.returns == expected.returns);
    CHECK(report.T_map_sensor.matrix() == expected.T_map_sensor.matrix());
  }
}

TEST_CASE("a scan with a pixel without its own point, range or capture time is refused") {
  const SensorModel sensor = test::small_sensor(16, 512);
  slam::Slam slam(sensor);
  const OrganizedCloud sound = drive_scan(sensor, 0);
  OrganizedCloud cloud = sound;
  cloud.points_m.pop_back();
  CHECK_THROWS_AS(slam.process(cloud, 0.0), Error);
  cloud = sound;
  cloud.range_m.push_back(1.0F);
  CHECK_THROWS_AS(slam.process(cloud, 0.0), Error);
  cloud = sound;
  cloud.time_offset_s.resize(1);
  CHECK_THROWS_AS(slam.process(cloud, 0.0), Error);
  cloud.time_offset_s.clear();
  CHECK_NOTHROW(slam.process(cloud, 0.0));
  CHECK(slam.trajectory().size() == 1);
}

TEST_CASE("capture times that are no offsets from the middle of the scan in seconds are refused") {
  const SensorModel sensor = test::small_sensor(16, 512);
  slam::Slam slam(sensor);
  const OrganizedCloud sound = drive_scan(sensor, 0);
  const auto changed = [&](float factor, float shift_s) {
    OrganizedCloud cloud = sound;
    for (float& offset_s : cloud.time_offset_s) offset_s = factor * offset_s + shift_s;
    return cloud;
  };
  const auto period_s = static_cast<float>(sensor.scan_period_s);
  const auto refused = [&](const OrganizedCloud& cloud) {
    return test::one_line_with(test::error_message([&] { slam.process(cloud, 0.0); }),
                               "capture times", "middle of the scan");
  };
  CHECK(refused(changed(1.0F, period_s / 2.0F)));   // from its beginning
  CHECK(refused(changed(1.0F, -period_s / 2.0F)));  // from its end
  CHECK(refused(changed(1.0F, 1.6e9F)));            // no offsets at all
  CHECK(refused(changed(1000.0F, 0.0F)));           // milliseconds
  CHECK_THROWS_AS(slam.process(changed(1e6F, 0.0F), 0.0), ScanError);
  CHECK(slam.trajectory().empty());
  CHECK_NOTHROW(slam.process(changed(1.0F, period_s / 10.0F), 0.0));
  CHECK_NOTHROW(slam.process(changed(1.5F, 0.0F), 0.1));  // a head that is slower than its model
  OrganizedCloud half = changed(1.0F, 0.0F);              // returns of one half of the turn alone
  for (std::size_t k = 0; k < half.range_m.size(); ++k) {
    if (half.time_offset_s[k] < 0.0F) half.range_m[k] = 0.0F;
  }
  CHECK_NOTHROW(slam.process(half, 0.2));
  // Of pixels without a return the times mean nothing.
  OrganizedCloud cloud = sound;
  cloud.range_m[5] = 0.0F;
  cloud.time_offset_s[5] = 1e9F;
  CHECK_NOTHROW(slam.process(cloud, 0.3));
}

TEST_CASE("the number of threads is an option, and the caller's own stays as it was") {
  const SensorModel sensor = test::small_sensor(16, 512);
  const int before = omp_get_max_threads();
  std::vector<Pose> last;
  for (const int threads : {1, 3}) {
    slam::SlamOptions options;
    options.threads = threads;
    slam::Slam slam(sensor, options);
    for (int i = 0; i < 5; ++i) slam.process(drive_scan(sensor, i), i * kPeriod_s);
    last.push_back(slam.trajectory().back().T_map_sensor);
    CHECK(omp_get_max_threads() == before);
  }
  CHECK(last[0].matrix() == last[1].matrix());
}

TEST_CASE("a scan of another shape is refused") {
  slam::Slam slam(test::small_sensor(16, 512));
  CHECK_THROWS_AS(slam.process(OrganizedCloud(64, 1024), 0.0), Error);
  SensorModel broken = test::small_sensor(16, 512);
  broken.columns = 0;
  CHECK_THROWS_AS(slam::Slam{broken}, Error);
}

TEST_CASE("a drive that drifts by metres is closed, smoothly, the same whatever the threads") {
  const test::Circuit circuit = test::circuit();
  const SensorModel sensor = test::small_sensor(16, 360);
  std::vector<OrganizedCloud> scans;
  for (const Pose& T_village_sensor : circuit.T_village_sensor) {
    scans.push_back(bent(circuit.village.scan(sensor, T_village_sensor)));
  }
  std::vector<ClosedDrive> closed;
  const int threads_before = omp_get_max_threads();
  for (const int threads : {1, 2}) {
    omp_set_num_threads(threads);
    closed.push_back(drive_around(sensor, scans));
  }
  omp_set_num_threads(threads_before);

  const std::vector<slam::ScanReport>& reports = closed[0].reports;
  const auto is_closed = [](const slam::ScanReport& report) {
    return report.loop.status == slam::LoopStatus::kClosed;
  };
  const auto first_closed = std::find_if(reports.begin(), reports.end(), is_closed);
  REQUIRE(first_closed < reports.end() - 1);
  const auto at = static_cast<std::size_t>(first_closed - reports.begin());
  CHECK(reports[at].loop.correction_m > 2.0);
  CHECK(reports[at].loop.older_scan < at / 2);
  CHECK(closing_error_m(closed[0], circuit) < 0.3);

  // The next scan is followed as if nothing had happened, and the odometry knows nothing of it.
  const auto step_m = [&](Pose slam::ScanReport::*T_sensor, std::size_t i) {
    return ((reports[i - 1].*T_sensor).inverse() * (reports[i].*T_sensor)).translation().norm();
  };
  CHECK(step_m(&slam::ScanReport::T_map_sensor, at + 1) == doctest::Approx(1.5).epsilon(0.1));
  CHECK(step_m(&slam::ScanReport::T_odom_sensor, at) == doctest::Approx(1.5).epsilon(0.1));
  CHECK(step_m(&slam::ScanReport::T_odom_sensor, at + 1) == doctest::Approx(1.5).epsilon(0.1));

  CHECK(closed[1].map_points_m == closed[0].map_points_m);
  for (std::size_t i = 0; i < reports.size(); ++i) {
    CHECK(closed[1].trajectory[i].T_map_sensor.matrix() ==
          closed[0].trajectory[i].T_map_sensor.matrix());
  }
}

// Whole drives against known trajectories, from file or simulator to pose.

#include "core/real_data.h"
#include "hqslam/core/angles.h"
#include "hqslam/core/npy.h"
#include "hqslam/evaluation/trajectory_error.h"
#include "hqslam/recordings/recording.h"
#include "hqslam/sim/drive.h"
#include "hqslam/slam/options.h"
#include "hqslam/slam/saved_map.h"
#include "hqslam/slam/slam.h"
#include "testing.h"

namespace {

struct TrackedDrive {
  Trajectory estimate;
  Trajectory truth;
};

/// What is made of the samples of an inertial sensor; nothing: it has none.
using Inertial = std::function<ImuSample(ImuSample)>;
const Inertial kRight = [](const ImuSample& sample) { return sample; };

TrackedDrive track_simulated(const sim::DriveSpec& spec, const char* sensor_name, int rows,
                             const Inertial& inertial = {}) {
  const SensorModel sensor = sensor_preset(sensor_name);
  const RowSelection selection = selection_for(sensor.rows(), rows);
  sim::DriveSimulator simulator(spec, sensor);
  const SensorModel selected = select_rows(sensor, selection);
  slam::Slam slam(selected);
  TrackedDrive result;
  while (const auto scan = simulator.next()) {
    std::vector<ImuSample> samples;
    if (inertial) std::ranges::transform(scan->imu, std::back_inserter(samples), inertial);
    slam.add_imu(samples);
    slam.process(unproject(select_rows(scan->image, selection), selected, CaptureTime::kRolling),
                 scan->stamp_s);
    result.truth.push_back({scan->stamp_s, scan->T_map_sensor});
  }
  slam.finish();
  result.estimate = slam.trajectory();
  return result;
}

sim::DriveSpec drive(const char* name, std::uint64_t seed, std::int64_t scans,
                     sim::SensorErrors errors = sim::SensorErrors::kTypical) {
  sim::DriveSpec spec = sim::drive_preset(name);
  spec.seed = seed;
  spec.scans = scans;
  spec.sensor_errors = errors;
  return spec;
}

/// The largest angle between the vertical of the first pose, carried along, and the true one.
double worst_lean_rad(const TrackedDrive& drive) {
  double worst_rad = 0.0;
  for (std::size_t i = 0; i < drive.truth.size(); ++i) {
    const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d found = drive.estimate[i].T_map_sensor.linear().transpose() * up;
    const Eigen::Vector3d truth = drive.truth[i].T_map_sensor.linear().transpose() * up;
    worst_rad = std::max(worst_rad, std::acos(std::min(1.0, found.dot(truth))));
  }
  return worst_rad;
}

double ape_rmse_m(const TrackedDrive& drive) {
  return absolute_pose_error(drive.estimate, drive.truth, Alignment::kSe3)
      .translation_statistics.rmse;
}

/// The recorded HDL-64E drive of HQSLAM_DATA, or an empty result where that is not set.
TrackedDrive track_recorded(int rows) {
  const auto folder = real_data("kitti_drive_0005");
  if (!folder) return {};
  TrackedDrive result;
  const SensorModel sensor = sensor_preset("hdl-64e");
  const RowSelection selection = selection_for(sensor.rows(), rows);
  auto source = recordings::Recording::open(*folder + "/velodyne", {.sensor = "hdl-64e"});
  slam::Slam slam(select_rows(sensor, selection));
  while (const auto scan = source.next()) {
    slam.process(select_rows(scan->cloud, selection), scan->stamp_s);
  }
  result.estimate = slam.trajectory();
  // A pose per scan, without the stamps that the scans have.
  result.truth = read_kitti_poses(*folder + "/poses_icp.txt");
  for (std::size_t scan = 0; scan < result.truth.size(); ++scan) {
    result.truth[scan].stamp_s = result.estimate.at(scan).stamp_s;
  }
  return result;
}

/// Mean over a simulated drive of e^T C^-1 e, e being the error of a pose and C its covariance: 6
/// if the covariance is right. Where this many scans from the 30th on are blind, of what follows
/// them.
double normalised_error_squared(const char* name, std::uint64_t seed, std::int64_t scans,
                                std::int64_t blind = 0) {
  constexpr std::int64_t kSeen = 30;
  const SensorModel sensor = sensor_preset("os1-16");
  sim::DriveSimulator simulator(drive(name, seed, scans), sensor);
  slam::Slam slam(sensor);
  double sum = 0.0;
  std::int64_t counted = 0;
  for (std::int64_t i = 0; i < scans; ++i) {
    const auto scan = simulator.next();
    OrganizedCloud cloud = unproject(scan->image, sensor, CaptureTime::kRolling);
    if (i >= kSeen && i < kSeen + blind) cloud = OrganizedCloud(cloud.rows, cloud.columns);
    const auto report = slam.process(cloud, scan->stamp_s);
    if (i == 0 || (blind > 0 && i < kSeen + blind)) continue;
    ++counted;
    const Twist twist = logarithm(report.T_map_sensor.inverse() * scan->T_map_sensor);
    Eigen::Matrix<double, 6, 1> error;
    error << twist.linear, twist.angular;
    sum += error.dot(report.covariance.ldlt().solve(error));
  }
  return sum / static_cast<double>(counted);
}

}  // namespace

TEST_CASE("squared errors are what their covariances say, within a factor of two over six drives") {
  double mean = 0.0;
  for (const std::uint64_t seed : {1, 2, 3}) {
    for (const char* drive : {"town", "hills"}) {
      mean += normalised_error_squared(drive, seed, 100) / 6.0;
    }
  }
  CHECK(mean > 3.0);
  CHECK(mean < 12.0);  // 4.0
}

TEST_CASE("what a blind stretch leaves unknown of a pose is what its covariance says") {
  // 2.0 after a second, which is bridged, and 2.9 after three: tracking is lost then, and poses
  // that are 17 and 23 m off have sigmas of 38 m. Single drives have 0.8 to 4.0.
  for (const std::int64_t blind : {10, 30}) {
    CAPTURE(blind);
    double mean = 0.0;
    for (const std::uint64_t seed : {7041, 7042, 7043, 7044}) {
      for (const char* drive : {"town", "hills"}) {
        mean += normalised_error_squared(drive, seed, 40 + blind, blind) / 8.0;
      }
    }
    CHECK(mean > 1.5);
    CHECK(mean < 12.0);
  }
}

TEST_CASE("streets, an alley, a start between walls and rooms are tracked to 0.15 m or better") {
  using Drive = std::tuple<const char*, std::uint64_t, std::int64_t, const char*, int, double>;
  for (const auto& [kind, seed, scans, sensor, rows, most_m] : {
           Drive{"block", 1, 200, "os1-64", 64, 0.05}, Drive{"block", 1, 200, "os1-64", 16, 0.05},
           Drive{"narrow", 103, 50, "os1-16", 16, 0.1},   // wide searches: metres off in a second
           Drive{"hills", 7090, 60, "os1-16", 16, 0.15},  // with inertial data once 6.6
           Drive{"indoors", 7105, 20, "os1-16", 16, 0.04},
           Drive{"indoors", 7202, 140, "os1-64", 64, 0.08},  // large voxels: lost in a doorway
       }) {
    CAPTURE(seed);
    CHECK(ape_rmse_m(track_simulated(drive(kind, seed, scans), sensor, rows)) <= most_m);
  }
  CHECK(ape_rmse_m(track_simulated(drive("hills", 7090, 60), "os1-16", 16, kRight)) <= 0.15);
}

TEST_CASE("rooms are mapped in small voxels: to 0.02 m, where those of streets lose the height") {
  const sim::DriveSpec rooms = drive("indoors", 703, 150, sim::SensorErrors::kNone);
  CHECK(ape_rmse_m(track_simulated(rooms, "os1-64", 16)) <= 0.02);  // before: 0.032
  const sim::DriveSpec no_floor = drive("indoors", 536, 200);
  CHECK(ape_rmse_m(track_simulated(no_floor, "os1-16", 16, kRight)) <= 0.03);  // before: 0.10
}

TEST_CASE("stairs are climbed without an inertial sensor to 0.1 m") {
  // On a flight no ground holds height and tilt. Before: 0.3 m, leaning by 16 degrees.
  const sim::DriveSpec stairs = drive("indoors", 575, 290);
  const TrackedDrive tracked = track_simulated(stairs, "os1-16", 16);
  CHECK(ape_rmse_m(tracked) <= 0.1);
  const TrackedDrive upstairs{{tracked.estimate.end() - 20, tracked.estimate.end()},
                              {tracked.truth.end() - 20, tracked.truth.end()}};
  CHECK(worst_lean_rad(upstairs) <= 1.0 * kDegree_rad);
}

TEST_CASE("a path along trunks and posts has its length to 0.07 %") {
  const sim::DriveSpec meadow = drive("meadow", 701, 150, sim::SensorErrors::kNone);
  const TrackedDrive tracked = track_simulated(meadow, "os1-64", 16);
  double found_m = 0.0;  // over seconds
  double true_m = 0.0;
  for (std::size_t i = 0; i + 10 < tracked.truth.size(); i += 10) {
    const auto moved_m = [i](const Trajectory& path) {
      return (path[i + 10].T_map_sensor.translation() - path[i].T_map_sensor.translation()).norm();
    };
    found_m += moved_m(tracked.estimate);
    true_m += moved_m(tracked.truth);
  }
  CHECK(std::abs(found_m / true_m - 1.0) < 7e-4);  // before: 0.16 % too short
}

TEST_CASE("an inertial sensor keeps a path upright that leans by beams that are off") {
  const sim::DriveSpec town = drive("town", 101, 200);
  const double with_rad = worst_lean_rad(track_simulated(town, "os1-16", 16, kRight));
  CHECK(with_rad < 0.4 * worst_lean_rad(track_simulated(town, "os1-16", 16)));
}

TEST_CASE("an inertial sensor with negated rates, or late, costs a drive nothing") {
  const sim::DriveSpec town = drive("town", 2, 200, sim::SensorErrors::kNone);
  const double without_m = ape_rmse_m(track_simulated(town, "os1-16", 16));
  const auto worse = [&](const Inertial& inertial) {
    return ape_rmse_m(track_simulated(town, "os1-16", 16, inertial)) / without_m;
  };
  CHECK(worse([](ImuSample sample) {
          sample.angular_rate_rad_per_s *= -1.0;
          return sample;
        }) < 1.2);  // before: 11
  CHECK(worse([](ImuSample sample) {
          sample.stamp_s += 0.2;
          return sample;
        }) < 1.2);  // before: 17
}

TEST_CASE("a hand with a scan a second is located by single scans where its odometry fails") {
  const auto folder = real_data("handheld_os0");
  if (!folder) return;
  NpyStackReader stack(*folder + "/scans.npy");
  const RowSelection rows = selection_for(64, 16);
  const SensorModel sensor = select_rows(load_sensor(*folder + "/sensor.json"), rows);
  const auto process = [&](slam::Slam& slam, int scan) {
    return slam.process(
        unproject(select_rows(stack.read(scan), rows), sensor, CaptureTime::kMotionCorrected),
        0.5 * scan);
  };
  slam::Slam mapped(sensor);
  for (int scan = 0; scan < 90; scan += 2) process(mapped, scan);
  mapped.finish();
  slam::Slam slam(sensor, {}, mapped.saved_map());
  int located = 0;
  for (int scan = 7; scan < 31; scan += 2) {
    located += slam::is_registered(process(slam, scan).mapping_status) ? 1 : 0;
  }
  CHECK(located >= 9);  // of 12; before: 0
}

TEST_CASE("the recorded HDL-64E drive is tracked to 0.05 m with 64 rows, 0.10 m with 16") {
  const TrackedDrive all_rows = track_recorded(64);
  if (all_rows.estimate.empty()) return;
  CHECK(all_rows.estimate.size() == 80);
  CHECK(ape_rmse_m(all_rows) <= 0.05);
  CHECK(ape_rmse_m(track_recorded(16)) <= 0.10);
}

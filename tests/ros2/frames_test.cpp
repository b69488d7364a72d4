#include "frames.h"

#include "testing.h"

using hqslam::Pose;
using hqslam::pose_from_xyz_rpy;
using hqslam::slam::LoopStatus;
using hqslam::slam::ScanReport;
using hqslam::slam::Status;
using hqslam_ros::Matrix6;
using hqslam_ros::RobotFrames;
using hqslam_ros::RobotState;

namespace {

constexpr double kQuarter_rad = std::numbers::pi / 2.0;

Pose at(double x_m, double y_m, double yaw_rad = 0.0, double z_m = 0.0) {
  return pose_from_xyz_rpy({x_m, y_m, z_m}, 0.0, 0.0, yaw_rad);
}

bool are_close(const Pose& a, const Pose& b) {
  return (a.matrix() - b.matrix()).cwiseAbs().maxCoeff() < 1e-9;
}

/// What SLAM says scan by scan, and the path that it corrects.
struct Drive {
  RobotFrames frames;
  hqslam::Trajectory path;

  RobotState next(const Pose& T_map_sensor, ScanReport report = {}) {
    report.T_map_sensor = T_map_sensor;
    path.push_back({0.1 * static_cast<double>(path.size()), T_map_sensor});
    return frames.next(report, path);
  }
};

}  // namespace

TEST_CASE("base begins at map's origin, wherever the LiDAR is on it and however it leans") {
  const Pose T_base_lidar = pose_from_xyz_rpy({1.0, 0.5, 2.0}, 3.0, 0.2, -2.0);
  // SLAM's first pose is how the sensor leans: its map is level, and turned as the sensor is.
  Drive drive{RobotFrames(T_base_lidar, false), {}};
  const RobotState robot = drive.next(pose_from_xyz_rpy({0.0, 0.0, 0.0}, 3.0, 0.2, 0.0));
  CHECK(are_close(robot.T_map_base, Pose::Identity()));
  CHECK(are_close(robot.T_odom_base, Pose::Identity()));
}

TEST_CASE("a robot with its LiDAR ahead, looking left, drives 3 m and turns to the left") {
  // In SLAM's map, whose axes are the LiDAR's at first, ahead is -y, and the LiDAR begins where it
  // is on the robot. By the turn it comes from 1 m ahead of the robot to 1 m beside it.
  Drive drive{RobotFrames(at(1.0, 0.0, kQuarter_rad, 2.0), false), {}};
  drive.next(at(0.0, 0.0));
  CHECK(are_close(drive.next(at(0.0, -3.0)).T_map_base, at(3.0, 0.0)));
  const RobotState robot = drive.next(at(1.0, -2.0, kQuarter_rad));
  CHECK(are_close(robot.T_map_base, at(3.0, 0.0, kQuarter_rad)));
  CHECK(are_close(robot.T_odom_base, robot.T_map_base));
}

TEST_CASE("a loop moves map -> odom and leaves odom smooth") {
  Drive drive{RobotFrames(Pose::Identity(), false), {}};
  drive.next(at(0.0, 0.0));
  drive.next(at(10.0, 0.0));
  drive.path.back().T_map_sensor = at(10.0, 0.0, kQuarter_rad);  // the loop turns it to the left
  const RobotState robot = drive.next(at(10.0, 1.0, kQuarter_rad));
  CHECK(are_close(robot.T_map_base, at(10.0, 1.0, kQuarter_rad)));
  CHECK(are_close(robot.T_odom_base, at(11.0, 0.0)));
  // odom's (11, 0), turned to (0, 11), is map's (10, 1).
  CHECK(are_close(hqslam_ros::T_map_odom(robot.T_map_base, robot.T_odom_base),
                  at(10.0, -10.0, kQuarter_rad)));
}

TEST_CASE("while a place is not recognized, and when it is, odom moves with the odometry") {
  Drive drive{RobotFrames(at(0.0, 0.0, 0.0, 1.0), true), {}};
  const auto lost = [](double x_m) {
    ScanReport report;
    report.mapping_status = Status::kNotRecognized;
    report.T_odom_sensor = at(x_m, 0.0);
    return report;
  };
  drive.next(at(0.0, 0.0), lost(0.0));
  CHECK(are_close(drive.next(at(0.0, 0.0), lost(2.0)).T_odom_base, at(2.0, 0.0)));
  ScanReport found;
  found.T_odom_sensor = at(3.0, 0.0);
  const RobotState robot = drive.next(at(50.0, 7.0, 0.0, 1.0), found);
  CHECK(are_close(robot.T_odom_base, at(3.0, 0.0)));
  CHECK(are_close(robot.T_map_base, at(50.0, 7.0)));  // of a given map, whose frame is map
  CHECK(are_close(drive.next(at(51.0, 7.0, 0.0, 1.0)).T_odom_base, at(4.0, 0.0)));
}

TEST_CASE(
    "covariances are of base, in the axes of the frame, and infinite where nothing is known") {
  Drive drive{RobotFrames(at(0.0, 0.0, 0.0, 2.0), false), {}};
  ScanReport report;
  report.covariance(3, 3) = 0.01;  // the LiDAR, 2 m above base, may roll
  const RobotState robot = drive.next(at(0.0, 0.0, kQuarter_rad), report);
  // Base swings to its sides by twice that, which is along map's x.
  CHECK(robot.map_covariance(0, 0) == doctest::Approx(0.04));
  CHECK(robot.map_covariance(1, 1) == doctest::Approx(0.0));
  CHECK(robot.map_covariance(4, 4) == doctest::Approx(0.01));
  report.covariance.setZero();
  report.covariance.diagonal().setConstant(std::numeric_limits<double>::infinity());
  CHECK(drive.next(at(0.0, 0.0), report).map_covariance == report.covariance);
  CHECK(drive.next(at(0.0, 0.0)).odom_covariance.allFinite());
}

TEST_CASE("what loops take from the covariance in the map stays in that of odom") {
  Drive drive{RobotFrames(Pose::Identity(), false), {}};
  const auto variance_m2 = [&](double of_map, LoopStatus loop = LoopStatus::kNotSearched) {
    ScanReport report;
    report.covariance = of_map * Matrix6::Identity();
    report.loop.status = loop;
    return drive.next(Pose::Identity(), report).odom_covariance(0, 0);
  };
  variance_m2(0.0);
  CHECK(variance_m2(0.3) == doctest::Approx(0.3));
  CHECK(variance_m2(0.05, LoopStatus::kClosed) == doctest::Approx(0.3));
  CHECK(variance_m2(0.06) == doctest::Approx(0.31));
}

TEST_CASE("the velocity is that of base: a LiDAR ahead of it swings when it turns") {
  Drive drive{RobotFrames(at(1.0, 0.0), false), {}};
  ScanReport report;
  report.velocity = {{2.0, 0.5, 0.0}, {0.0, 0.0, 0.5}};
  report.velocity_covariance(5, 5) = 0.04;
  const RobotState robot = drive.next(Pose::Identity(), report);
  CHECK(robot.velocity.linear.isApprox(Eigen::Vector3d(2.0, 0.0, 0.0)));
  CHECK(robot.velocity.angular.isApprox(Eigen::Vector3d(0.0, 0.0, 0.5)));
  CHECK(robot.velocity_covariance(1, 1) == doctest::Approx(0.04));
}

TEST_CASE("a saved map moves with its places") {
  hqslam::slam::SavedMap map;
  map.edges_m = map.posts_m = map.planes_m = {{1.0F, 0.0F, 0.0F}};
  map.places.push_back({at(1.0, 0.0), {}});
  const auto other = hqslam_ros::moved(map, at(5.0, 0.0, kQuarter_rad));
  for (const auto* kind : {&other.edges_m, &other.posts_m, &other.planes_m}) {
    CHECK((kind->front() - Eigen::Vector3f(5.0F, 1.0F, 0.0F)).norm() < 1e-6F);
  }
  CHECK(are_close(other.places.front().T_map_sensor, at(5.0, 1.0, kQuarter_rad)));
}

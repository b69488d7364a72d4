#include "front_end/mounting.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include "front_end/ground.h"
#include "front_end/voxel_thinning.h"

namespace hqslam::slam {

namespace {

/// Checked on simulated sensors alone, which lean by up to 30 degrees.
constexpr double kMostCorrected_rad = std::numbers::pi / 6.0;
constexpr double kSteepest_rad = kMostCorrected_rad + kMaxGroundSlope_rad;
/// Where the ground leans by more, the stated mounting is wrong: the ground leans by up to 3.4
/// degrees in the frame of a vehicle (simulated hills), 3 in real recordings.
constexpr double kMostUnstated_rad = std::numbers::pi / 36.0;
/// Then it has this many times the points of any plane that is level to half of that: a bank beside
/// a road has not.
constexpr double kLeaningGround = 2.0;
constexpr float kGroundReach_m = 25.0F;
constexpr double kLeaf_m = 0.5;
constexpr float kGroundThickness_m = 0.1F;
constexpr float kMinArea_m2 = 1.0F;  // of three points that determine a plane
constexpr Eigen::Index kMinGroundPoints = 50;

/// Half a turn about x: from a frame to the same one upside down, and back.
Eigen::Vector3d half_turned(const Eigen::Vector3d& p) { return {p.x(), -p.y(), -p.z()}; }

SensorModel upside_down(const SensorModel& sensor) {
  SensorModel result = sensor;
  for (int row = 0; row < sensor.rows(); ++row) {
    const int opposite = sensor.rows() - 1 - row;
    result.beam_elevation_rad[row] = -sensor.beam_elevation_rad[opposite];
    result.beam_azimuth_offset_rad[row] = -sensor.beam_azimuth_offset_rad[opposite];
  }
  if (sensor.measured_rows) {
    int last = sensor.rows() - 1;
    while (!sensor.measured_rows->contains(last)) --last;
    result.measured_rows->offset = sensor.rows() - 1 - last;
  }
  return result;
}

/// Candidates for the ground, thinned: points along which a column rises less steeply than
/// kSteepest_rad.
Eigen::Matrix3Xf ground_points_m(const OrganizedCloud& level, const SensorModel& upright_sensor,
                                 const Eigen::Vector3d& up_of_sensor) {
  const std::vector<std::uint8_t> is_ground =
      mark_ground(level, upright_sensor, up_of_sensor, kSteepest_rad);
  std::vector<FeaturePoint> points;
  for (std::size_t pixel = 0; pixel < is_ground.size(); ++pixel) {
    if (is_ground[pixel] != 0 && level.range_m[pixel] <= kGroundReach_m) {
      points.push_back({level.points_m[pixel]});
    }
  }
  points = thin(points, kLeaf_m);
  Eigen::Matrix3Xf result(3, points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    result.col(static_cast<Eigen::Index>(i)) = points[i].point_m;
  }
  return result;
}

/// Which points are near the plane through `point_m`.
Eigen::Array<bool, 1, Eigen::Dynamic> near_plane(const Eigen::Matrix3Xf& points_m,
                                                 const Eigen::Vector3f& point_m,
                                                 const Eigen::Vector3f& normal) {
  return (normal.transpose() * (points_m.colwise() - point_m)).array().abs() < kGroundThickness_m;
}

/// The normal of the plane through points: the direction of least variance.
Eigen::Vector3f fitted_normal(const Eigen::Matrix3Xf& points_m) {
  const Eigen::Matrix3Xf from_middle_m = points_m.colwise() - points_m.rowwise().mean();
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f>(from_middle_m * from_middle_m.transpose())
      .eigenvectors()
      .col(0);
}

struct GroundPlane {
  Eigen::Vector3d normal;  ///< upward
  Eigen::Index points;     ///< near it
};

/// The ground among points in a frame that is about level: the plane through three random points,
/// tilted by at most `max_tilt_rad`, with most points near it (RANSAC; Fischler & Bolles, 1981),
/// fitted to those.
std::optional<GroundPlane> ground_plane(const Eigen::Matrix3Xf& points_m, double max_tilt_rad) {
  constexpr int kDraws = 500;
  const Eigen::Index count = points_m.cols();
  if (count < kMinGroundPoints) return std::nullopt;
  std::mt19937 random;  // fixed seed
  const auto drawn = [&]() -> Eigen::Vector3f {
    return points_m.col(random() % static_cast<std::uint32_t>(count));
  };
  Eigen::Array<bool, 1, Eigen::Dynamic> best;
  Eigen::Index most = kMinGroundPoints - 1;
  for (int draw = 0; draw < kDraws; ++draw) {
    const Eigen::Vector3f a_m = drawn();
    const Eigen::Vector3f b_m = drawn();
    const Eigen::Vector3f normal_m2 = (b_m - a_m).cross(drawn() - a_m);
    if (normal_m2.norm() < kMinArea_m2) continue;
    const Eigen::Vector3f normal = normal_m2.normalized();
    if (std::abs(normal.z()) < std::cos(max_tilt_rad)) continue;
    const auto near = near_plane(points_m, a_m, normal);
    if (near.count() <= most) continue;
    most = near.count();
    best = near;
  }
  if (best.size() == 0) return std::nullopt;
  Eigen::Matrix3Xf ground_m(3, most);
  for (Eigen::Index i = 0, k = 0; i < count; ++i) {
    if (best[i]) ground_m.col(k++) = points_m.col(i);
  }
  const Eigen::Vector3d normal = fitted_normal(ground_m).cast<double>();
  return GroundPlane{normal.z() < 0.0 ? Eigen::Vector3d(-normal) : normal, most};
}

/// Whether the ground leans so much that the mounting cannot be as stated.
bool contradicts_level(const GroundPlane& ground, const Eigen::Matrix3Xf& points_m) {
  if (ground.normal.z() > std::cos(kMostUnstated_rad)) return false;
  const std::optional<GroundPlane> level = ground_plane(points_m, 0.5 * kMostUnstated_rad);
  return !level ||
         static_cast<double>(ground.points) > kLeaningGround * static_cast<double>(level->points);
}

/// Roll r and pitch p, as in pose_from_xyz_rpy, from the vertical in the sensor's frame,
/// (-sin p, cos p sin r, cos p cos r).
MountingOptions leaning(const Eigen::Vector3d& up_of_sensor) {
  return {std::atan2(up_of_sensor.y(), up_of_sensor.z()),
          -std::asin(std::clamp(up_of_sensor.x(), -1.0, 1.0))};
}

}  // namespace

Eigen::Matrix3d R_level_sensor(const MountingOptions& mounted) {
  return pose_from_xyz_rpy(Eigen::Vector3d::Zero(), mounted.roll_rad, mounted.pitch_rad, 0.0)
      .linear();
}

Mounting::Mounting(const MountingOptions& options, const SensorModel& sensor)
    : mounted_{options.roll_rad, options.pitch_rad, false},
      is_always_estimated_(options.estimated),
      R_level_sensor_(R_level_sensor(mounted_)),
      is_upside_down_(R_level_sensor_(2, 2) < 0.0),
      upright_sensor_(is_upside_down_ ? upside_down(sensor) : sensor) {}

Eigen::Vector3d Mounting::up_of_upright_sensor(const Eigen::Vector3d& up) const {
  const Eigen::Vector3d up_of_sensor = R_level_sensor_.transpose() * up;
  return is_upside_down_ ? half_turned(up_of_sensor) : up_of_sensor;
}

bool Mounting::correct_from_ground(const OrganizedCloud& cloud) {
  const std::optional<OrganizedCloud> turned = level(cloud);
  const Eigen::Matrix3Xf points_m =
      ground_points_m(turned ? *turned : cloud, upright_sensor_, up_of_upright_sensor());
  const std::optional<GroundPlane> ground = ground_plane(points_m, kMostCorrected_rad);
  if (!ground) return false;
  is_compared_ = true;
  if (!is_always_estimated_ && !contradicts_level(*ground, points_m)) return true;
  mounted_ = leaning(R_level_sensor_.transpose() * ground->normal);
  mounted_.estimated = true;
  R_level_sensor_ = R_level_sensor(mounted_);
  return true;
}

std::optional<OrganizedCloud> Mounting::level(const OrganizedCloud& cloud) const {
  if (R_level_sensor_.isIdentity(0.0)) return std::nullopt;
  const Eigen::Matrix3f R = R_level_sensor_.cast<float>();
  OrganizedCloud result = cloud;
  for (Eigen::Vector3f& point_m : result.points_m) point_m = R * point_m;
  if (is_upside_down_) {
    std::ranges::reverse(result.points_m);
    std::ranges::reverse(result.range_m);
    std::ranges::reverse(result.time_offset_s);
    std::ranges::reverse(result.confidence);
    std::ranges::reverse(result.intensity);
  }
  return result;
}

Pose Mounting::of_sensor(const Pose& T_map_level) const {
  return T_map_level * Pose(R_level_sensor_);
}

Matrix6 Mounting::of_sensor(const Matrix6& covariance) const {
  if (!covariance.allFinite()) return covariance;
  const Matrix6 turn = adjoint(Pose(R_level_sensor_.transpose()));
  return turn * covariance * turn.transpose();
}

Twist Mounting::of_sensor(const Twist& motion) const {
  const Eigen::Matrix3d R_sensor_level = R_level_sensor_.transpose();
  return {R_sensor_level * motion.linear, R_sensor_level * motion.angular};
}

std::vector<std::uint8_t> mark_ground_of(const OrganizedCloud& cloud, const SensorModel& sensor,
                                         const Eigen::Vector3d& up_of_sensor) {
  const Mounting mounting(leaning(up_of_sensor), sensor);
  const std::optional<OrganizedCloud> level = mounting.level(cloud);
  std::vector<std::uint8_t> ground = mark_ground(level ? *level : cloud, mounting.upright_sensor(),
                                                 mounting.up_of_upright_sensor());
  if (up_of_sensor.z() < 0.0) std::ranges::reverse(ground);
  return ground;
}

}  // namespace hqslam::slam

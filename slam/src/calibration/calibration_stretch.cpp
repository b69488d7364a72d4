#include "calibration/calibration_stretch.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "alignment/motion_state.h"
#include "front_end/cell_index.h"

namespace hqslam::slam {

namespace {

constexpr int kColumnsOfScan = 128;
constexpr double kMinRange_m = 1.0;
constexpr double kMaxRange_m = 80.0;  ///< chosen with kMinPoints, a raw HDL-64E included
constexpr double kVoxel_m = 1.0;
constexpr std::size_t kMinPoints = 8;
constexpr int kMinBeams = 3;
constexpr double kMaxThickness_m = 0.15;
constexpr double kMaxThicknessShare = 0.3;  ///< of the width across
constexpr double kMinWidth_m = 0.17;
constexpr double kNoise_m = 0.03;
/// Errors of a surface's points are correlated: this many weigh as much as one. With ten a
/// raw HDL-64E is less accurate.
constexpr double kPointsOfOneError = 20.0;
/// Prior of the poses, for directions that no surface constrains, m and rad.
constexpr double kPoseSigma = 10.0;
constexpr double kHeldInformation = 1e8;
constexpr double kGroundUprightness = 0.8;
constexpr double kWallUprightness = 0.3;

/// The key of a point's voxel, by which rays are sorted.
std::uint64_t voxel_key(const Eigen::Vector3d& point_m) {
  const Eigen::Array3d cell = (point_m / kVoxel_m).array().floor();
  const double range = CellIndex::kRange;
  return CellIndex::key_of(cell.max(-range).min(range - 1.0).cast<int>());
}

/// A ray at the current estimates of its scan's pose and its beam's correction.
struct PlacedRay {
  std::uint64_t voxel = 0;
  const CalibrationRay* ray = nullptr;
  Eigen::Vector3d point_m;
};

std::vector<PlacedRay> placed_rays(const CalibrationStretch& stretch, const BeamParameters& beams) {
  std::vector<PlacedRay> result;
  result.reserve(stretch.rays.size());
  for (const CalibrationRay& ray : stretch.rays) {
    const Eigen::Vector3d direction = ray.direction + beams[2 * ray.beam] * ray.tilt;
    const Eigen::Vector3d point_m =
        stretch.T_map_sensor[static_cast<std::size_t>(ray.scan)] *
        ((ray.range_m + beams[2 * ray.beam + 1]) * direction + ray.offset_m);
    result.push_back({voxel_key(point_m), &ray, point_m});
  }
  std::ranges::stable_sort(result, {}, &PlacedRay::voxel);
  return result;
}

/// The plane through the points of a voxel: its axes, the normal first.
struct Surface {
  Eigen::Vector3d centre_m;
  Eigen::Matrix3d axes;
};

bool is_plane(std::span<const PlacedRay> rays, Surface& surface) {
  if (rays.size() < kMinPoints) return false;
  std::vector<int> beams;
  surface.centre_m.setZero();
  for (const PlacedRay& placed : rays) {
    surface.centre_m += placed.point_m / static_cast<double>(rays.size());
    if (std::ranges::find(beams, placed.ray->beam) == beams.end()) {
      beams.push_back(placed.ray->beam);
    }
  }
  if (std::ssize(beams) < kMinBeams) return false;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const PlacedRay& placed : rays) {
    const Eigen::Vector3d offset_m = placed.point_m - surface.centre_m;
    covariance += offset_m * offset_m.transpose() / static_cast<double>(rays.size());
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  surface.axes = solver.eigenvectors();
  const Eigen::Vector3d widths_m = solver.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  return widths_m[0] < kMaxThickness_m && widths_m[1] > kMinWidth_m &&
         widths_m[0] < kMaxThicknessShare * widths_m[1];
}

/// Adds a surface's points to the system and eliminates its plane. With J the rows of all points,
/// W their weights and B = (1, u, v) the derivatives by the plane's offset and tilts,
///   H += J^T W J - (B^T W J)^T (B^T W B)^-1 (B^T W J), and g alike.
class SurfaceSum {
 public:
  SurfaceSum(const CalibrationStretch& stretch, const Surface& surface, CalibrationSystem& system)
      : stretch_(stretch),
        surface_(surface),
        system_(system),
        beam_parameters_(2 * system.distances.rows()),
        planes_by_all_(Eigen::Matrix3Xd::Zero(3, system.g.size())) {}

  void add(const PlacedRay& placed, const BeamParameters& beams) {
    const CalibrationRay& ray = *placed.ray;
    const Eigen::Vector3d from_centre_m = placed.point_m - surface_.centre_m;
    const Eigen::Vector3d in_plane = surface_.axes.transpose() * from_centre_m;
    const double residual_m = in_plane[0];
    // Geman-McClure, iterated: a point more than 9 cm away belongs to something else.
    const double relative = residual_m / (3.0 * kNoise_m);
    const double robust = 1.0 / ((1.0 + relative * relative) * (1.0 + relative * relative));
    const double weight = robust / (kNoise_m * kNoise_m * kPointsOfOneError);

    const Eigen::Vector3d normal = surface_.axes.col(0);
    const Pose& T = stretch_.T_map_sensor[static_cast<std::size_t>(ray.scan)];
    const double range_m = ray.range_m + beams[2 * ray.beam + 1];
    const Eigen::Vector2d by_beam(range_m * normal.dot(T.linear() * ray.tilt),
                                  normal.dot(T.linear() * ray.direction));
    Vector6 by_pose;
    by_pose << normal, (placed.point_m - T.translation()).cross(normal);
    const Eigen::Index beam = 2 * ray.beam;
    const Eigen::Index pose = beam_parameters_ + 6 * ray.scan;
    system_.H.block<2, 2>(beam, beam) += weight * by_beam * by_beam.transpose();
    system_.H.block<6, 2>(pose, beam) += weight * by_pose * by_beam.transpose();
    system_.H.block<6, 6>(pose, pose) += weight * by_pose * by_pose.transpose();
    system_.g.segment<2>(beam) += weight * residual_m * by_beam;
    system_.g.segment<6>(pose) += weight * residual_m * by_pose;

    const Eigen::Vector3d by_plane(1.0, in_plane[1], in_plane[2]);
    planes_ += weight * by_plane * by_plane.transpose();
    residuals_ += weight * residual_m * by_plane;
    planes_by_all_.middleCols<2>(beam) += weight * by_plane * by_beam.transpose();
    planes_by_all_.middleCols<6>(pose) += weight * by_plane * by_pose.transpose();
    system_.weight += weight;
    system_.weighted_squares_m2 += weight * residual_m * residual_m;
    add_distance(ray.beam, normal, T.translation() - surface_.centre_m, residual_m * robust,
                 robust);
  }

  void finish() {
    const Eigen::Matrix3d inverse =
        (planes_ + 1e-9 * Eigen::Matrix3d::Identity()).ldlt().solve(Eigen::Matrix3d::Identity());
    // A surface meets few of the beams and poses: the columns of all others are zero.
    std::vector<Eigen::Index> met;
    for (Eigen::Index column = 0; column < planes_by_all_.cols(); ++column) {
      if (!planes_by_all_.col(column).isZero(0.0)) met.push_back(column);
    }
    const Eigen::Matrix3Xd by_met = planes_by_all_(Eigen::all, met);
    const Eigen::MatrixXd eliminated = by_met.transpose() * inverse * by_met;
    for (std::size_t i = 0; i < met.size(); ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        system_.H(met[i], met[j]) -=
            eliminated(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
      }
    }
    system_.g -= planes_by_all_.transpose() * (inverse * residuals_);
    ++system_.surfaces;
  }

 private:
  void add_distance(int beam, const Eigen::Vector3d& normal, const Eigen::Vector3d& to_sensor_m,
                    double distance_m, double count) {
    const double uprightness = std::abs(normal.z());
    const bool is_ground = uprightness > kGroundUprightness;
    if (!is_ground && uprightness > kWallUprightness) return;
    const double towards = is_ground ? normal.z() : normal.dot(to_sensor_m);
    system_.distances(beam, is_ground ? 0 : 2) += towards < 0.0 ? -distance_m : distance_m;
    system_.distances(beam, is_ground ? 1 : 3) += count;
  }

  const CalibrationStretch& stretch_;
  const Surface& surface_;
  CalibrationSystem& system_;
  Eigen::Index beam_parameters_;
  Eigen::Matrix3Xd planes_by_all_;
  Eigen::Matrix3d planes_ = Eigen::Matrix3d::Zero();
  Eigen::Vector3d residuals_ = Eigen::Vector3d::Zero();
};

/// The block of the poses (one at least) with its prior; the first pose is held.
Eigen::LDLT<Eigen::MatrixXd> solved_poses(const CalibrationSystem& system,
                                          Eigen::Index beam_parameters) {
  const Eigen::Index size = system.g.size() - beam_parameters;
  Eigen::MatrixXd H = system.H.bottomRightCorner(size, size);
  H.diagonal().array() += 1.0 / (kPoseSigma * kPoseSigma);
  H.diagonal().head<6>().array() += kHeldInformation;
  return H.ldlt();
}

}  // namespace

OrganizedCloud calibration_columns(const OrganizedCloud& cloud, int scan) {
  const int step = std::max(1, cloud.columns / kColumnsOfScan);
  std::vector<int> columns;
  for (int column = scan % step; column < cloud.columns; column += step) columns.push_back(column);
  OrganizedCloud result(cloud.rows, static_cast<int>(columns.size()));
  if (!cloud.time_offset_s.empty()) result.time_offset_s.resize(result.range_m.size());
  for (int row = 0; row < cloud.rows; ++row) {
    for (int column = 0; column < result.columns; ++column) {
      const std::size_t to = result.index(row, column);
      const std::size_t from = cloud.index(row, columns[static_cast<std::size_t>(column)]);
      result.points_m[to] = cloud.points_m[from];
      result.range_m[to] = cloud.range_m[from];
      if (!cloud.time_offset_s.empty()) result.time_offset_s[to] = cloud.time_offset_s[from];
    }
  }
  return result;
}

CalibrationStretch calibration_stretch(std::span<const LocatedScan> scans) {
  CalibrationStretch result;
  for (int scan = 0; scan < std::ssize(scans); ++scan) {
    const LocatedScan& located = scans[static_cast<std::size_t>(scan)];
    const OrganizedCloud cloud = calibration_columns(located.cloud, scan);
    result.T_map_sensor.push_back(located.T_map_sensor);
    for (std::size_t i = 0; i < cloud.range_m.size(); ++i) {
      const double range_m = cloud.range_m[i];
      if (!(range_m > kMinRange_m && range_m < kMaxRange_m)) continue;
      const Eigen::Vector3d direction = cloud.points_m[i].cast<double>().normalized();
      const double level = direction.head<2>().norm();
      const double time_s = cloud.time_offset_s.empty() ? 0.0 : cloud.time_offset_s[i];
      if (!(level > 0.0) || !std::isfinite(time_s)) continue;
      const Eigen::Vector3d tilt(-direction.x() * direction.z() / level,
                                 -direction.y() * direction.z() / level, level);
      const Pose moved = exponential(time_s * located.velocity);
      const int row = static_cast<int>(i) / cloud.columns;
      result.rays.push_back({row, scan, range_m, moved.linear() * direction, moved.linear() * tilt,
                             moved.translation()});
    }
  }
  return result;
}

CalibrationSystem linearized(const CalibrationStretch& stretch, const BeamParameters& beams) {
  const Eigen::Index size = beams.size() + 6 * std::ssize(stretch.T_map_sensor);
  CalibrationSystem system;
  system.H = Eigen::MatrixXd::Zero(size, size);
  system.g = Eigen::VectorXd::Zero(size);
  system.distances = Eigen::ArrayX4d::Zero(beams.size() / 2, 4);
  const std::vector<PlacedRay> rays = placed_rays(stretch, beams);
  for (auto first = rays.begin(); first != rays.end();) {
    const auto last = std::find_if(
        first, rays.end(), [&](const PlacedRay& other) { return other.voxel != first->voxel; });
    const std::span<const PlacedRay> of_voxel(first, last);
    first = last;
    Surface surface;
    if (!is_plane(of_voxel, surface)) continue;
    SurfaceSum sum(stretch, surface, system);
    for (const PlacedRay& ray : of_voxel) sum.add(ray, beams);
    sum.finish();
  }
  system.H = Eigen::MatrixXd(system.H.selfadjointView<Eigen::Lower>());
  return system;
}

void move_poses(CalibrationStretch& stretch, const CalibrationSystem& system,
                const Eigen::VectorXd& beam_change) {
  if (stretch.T_map_sensor.empty()) return;
  const Eigen::Index beams = beam_change.size();
  const Eigen::Index size = system.g.size() - beams;
  const Eigen::VectorXd change =
      -solved_poses(system, beams)
           .solve(system.g.tail(size) + system.H.bottomLeftCorner(size, beams) * beam_change);
  for (std::size_t scan = 0; scan < stretch.T_map_sensor.size(); ++scan) {
    const Vector6 of_scan = change.segment<6>(6 * static_cast<Eigen::Index>(scan));
    Pose& T = stretch.T_map_sensor[scan];
    T.linear() = rotation_of(of_scan.tail<3>()) * T.linear();
    T.translation() += of_scan.head<3>();
  }
}

BeamInformation beam_information(const CalibrationSystem& system, Eigen::Index beam_parameters) {
  const Eigen::Index size = system.g.size() - beam_parameters;
  if (size == 0) return {system.H, system.g};  // without scans there are no poses
  const auto coupling = system.H.bottomLeftCorner(size, beam_parameters);
  const auto poses = solved_poses(system, beam_parameters);
  return {system.H.topLeftCorner(beam_parameters, beam_parameters) -
              coupling.transpose() * poses.solve(coupling),
          system.g.head(beam_parameters) - coupling.transpose() * poses.solve(system.g.tail(size))};
}

}  // namespace hqslam::slam

#include "odometry.h"

#include <ceres/ceres.h>

#include <cmath>

#include "hqslam/core/angles.h"

namespace hqslam::lego_loam {

namespace {

constexpr int kSearches = 5;
constexpr int kStepsPerSearch = 5;
constexpr float kReach_m = 5.0F;
constexpr int kRowsBeside = 2;
constexpr std::size_t kMinLastEdges = 10;
constexpr std::size_t kMinLastPlanes = 100;
constexpr int kMinCorrespondences = 10;
constexpr double kWeightFall = 1.8;  // per metre
constexpr double kMinWeight = 0.1;
constexpr double kConverged_m = 0.001;
constexpr double kConverged_deg = 0.1;

/// R(s) p + s t: p before s sweeps of motion.
template <typename T>
Eigen::Matrix<T, 3, 1> before_motion(const Eigen::Vector3d& p, double s, const T* out_of_plane,
                                     const T* in_plane) {
  using Axis = Eigen::Matrix<T, 3, 1>;
  const Eigen::AngleAxis<T> roll(s * out_of_plane[1], Axis::UnitX());
  const Eigen::AngleAxis<T> pitch(s * out_of_plane[2], Axis::UnitY());
  const Eigen::AngleAxis<T> yaw(s * in_plane[2], Axis::UnitZ());
  const Axis t(in_plane[0], in_plane[1], out_of_plane[0]);
  return yaw * (pitch * (roll * Axis(p.cast<T>()))) + s * t;
}

/// weight n . (R(s) p + s t - q)
struct PlaneDistance {
  Eigen::Vector3d p;
  double s;
  Eigen::Vector3d n;
  Eigen::Vector3d q;
  double weight;
  template <typename T>
  bool operator()(const T* out_of_plane, const T* in_plane, T* residual) const {
    *residual = weight * n.dot(before_motion(p, s, out_of_plane, in_plane) - q.cast<T>());
    return true;
  }
};

/// weight (R(s) p + s t - q) x u: three numbers whose length is the distance from the line.
struct LineDistance {
  Eigen::Vector3d p;
  double s;
  Eigen::Vector3d u;
  Eigen::Vector3d q;
  double weight;
  template <typename T>
  bool operator()(const T* out_of_plane, const T* in_plane, T* residual) const {
    const Eigen::Matrix<T, 3, 1> off = before_motion(p, s, out_of_plane, in_plane) - q.cast<T>();
    Eigen::Map<Eigen::Matrix<T, 3, 1>> distance(residual);
    distance = weight * off.cross(u.cast<T>());
    return true;
  }
};

/// By how many sweeps a point was captured after one of the last scan.
double sweeps_between(const Point& last, const Point& now) {
  return 1.0 + sweep_fraction(now) - sweep_fraction(last);
}

std::optional<PlaneDistance> plane_distance(const RowTrees& last, const Point& feature,
                                            const SweepMotion& motion, bool weighted) {
  const auto plane = last.plane_at(moved(pose_of(motion), feature));
  if (!plane) return std::nullopt;
  const double s = sweeps_between(plane->nearest, feature);
  const Eigen::Vector3d p = pose_of(motion, s) * position_m(feature);
  const Eigen::Vector3d q = position_m(plane->nearest);
  const Eigen::Vector3d n =
      (position_m(plane->same_row) - q).cross(position_m(plane->other_row) - q).normalized();
  const double d = std::abs(n.dot(p - q));
  const double weight = weighted ? 1.0 - kWeightFall * d / std::sqrt(p.norm()) : 1.0;
  if (!(weight > kMinWeight)) return std::nullopt;
  return PlaneDistance{position_m(feature), s, n, q, weight};
}

std::optional<LineDistance> line_distance(const RowTrees& last, const Point& feature,
                                          const SweepMotion& motion, bool weighted) {
  const auto line = last.line_at(moved(pose_of(motion), feature));
  if (!line) return std::nullopt;
  const double s = sweeps_between(line->nearest, feature);
  const Eigen::Vector3d p = pose_of(motion, s) * position_m(feature);
  const Eigen::Vector3d q = position_m(line->nearest);
  const Eigen::Vector3d u = (position_m(line->other_row) - q).normalized();
  const double weight = weighted ? 1.0 - kWeightFall * (p - q).cross(u).norm() : 1.0;
  if (!(weight > kMinWeight)) return std::nullopt;
  return LineDistance{position_m(feature), s, u, q, weight};
}

/// Changes out_of_plane or in_plane; the other one is held.
void solve(ceres::Problem& problem, Eigen::Vector3d& held) {
  problem.SetParameterBlockConstant(held.data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.max_num_iterations = kStepsPerSearch;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
}

bool has_converged(const SweepMotion& before, const SweepMotion& after) {
  const Pose step = pose_of(before).inverse() * pose_of(after);
  return step.translation().norm() < kConverged_m &&
         degrees(rotation_angle_rad(step)) < kConverged_deg;
}

}  // namespace

Pose pose_of(const SweepMotion& motion, double s) {
  const Eigen::Vector3d t(motion.in_plane[0], motion.in_plane[1], motion.out_of_plane[0]);
  return pose_from_xyz_rpy(s * t, s * motion.out_of_plane[1], s * motion.out_of_plane[2],
                           s * motion.in_plane[2]);
}

RowTrees::RowTrees(const Cloud& cloud) : cloud_(cloud.makeShared()) {
  if (cloud.empty()) return;
  tree_.setInputCloud(cloud_);
  for (const Point& point : cloud) {
    const auto row = static_cast<std::size_t>(row_of(point));
    while (row_cloud_.size() <= row) row_cloud_.push_back(std::make_shared<Cloud>());
    row_cloud_[row]->push_back(point);
  }
  row_tree_.resize(row_cloud_.size());
  for (std::size_t row = 0; row < row_cloud_.size(); ++row) {
    if (!row_cloud_[row]->empty()) row_tree_[row].setInputCloud(row_cloud_[row]);
  }
}

std::optional<Point> RowTrees::nearest(const Point& p) const {
  std::vector<int> index(1);
  std::vector<float> distance_m2(1);
  if (cloud_->empty() || tree_.nearestKSearch(p, 1, index, distance_m2) < 1) return std::nullopt;
  if (!(distance_m2[0] < kReach_m * kReach_m)) return std::nullopt;
  return (*cloud_)[index[0]];
}

/// rank 0: the nearest of the row, 1: the second nearest.
std::optional<Point> RowTrees::nearest_in_row(int row, const Point& p, int rank) const {
  if (row < 0 || row >= static_cast<int>(row_cloud_.size()) || row_cloud_[row]->empty()) {
    return std::nullopt;
  }
  std::vector<int> index(rank + 1);
  std::vector<float> distance_m2(rank + 1);
  if (row_tree_[row].nearestKSearch(p, rank + 1, index, distance_m2) <= rank) return std::nullopt;
  if (!(distance_m2[rank] < kReach_m * kReach_m)) return std::nullopt;
  return (*row_cloud_[row])[index[rank]];
}

std::optional<Point> RowTrees::nearest_beside(int row, const Point& p) const {
  std::optional<Point> best;
  const auto distance_m = [&](const Point& q) { return (position_m(q) - position_m(p)).norm(); };
  for (int beside = row - kRowsBeside; beside <= row + kRowsBeside; ++beside) {
    if (beside == row) continue;
    const auto found = nearest_in_row(beside, p, 0);
    if (found && (!best || distance_m(*found) < distance_m(*best))) best = found;
  }
  return best;
}

std::optional<RowTrees::Line> RowTrees::line_at(const Point& p) const {
  const auto closest = nearest(p);
  if (!closest) return std::nullopt;
  const auto other_row = nearest_beside(row_of(*closest), p);
  if (!other_row) return std::nullopt;
  return Line{*closest, *other_row};
}

std::optional<RowTrees::Plane> RowTrees::plane_at(const Point& p) const {
  const auto closest = nearest(p);
  if (!closest) return std::nullopt;
  const auto same_row = nearest_in_row(row_of(*closest), p, 1);
  const auto other_row = nearest_beside(row_of(*closest), p);
  if (!same_row || !other_row) return std::nullopt;
  return Plane{*closest, *same_row, *other_row};
}

int Odometry::match_planes(const Cloud& flat) {
  int matched = 0;
  for (int search = 0; search < kSearches; ++search) {
    const SweepMotion before = motion_;
    ceres::Problem problem;
    for (const Point& feature : flat) {
      const auto found = plane_distance(*ground_target_, feature, before, search > 0);
      if (!found) continue;
      problem.AddResidualBlock(
          new ceres::AutoDiffCostFunction<PlaneDistance, 1, 3, 3>(new PlaneDistance(*found)),
          nullptr, motion_.out_of_plane.data(), motion_.in_plane.data());
    }
    matched = problem.NumResidualBlocks();
    if (matched < kMinCorrespondences) return 0;
    solve(problem, motion_.in_plane);
    if (has_converged(before, motion_)) break;
  }
  return matched;
}

int Odometry::match_edges(const Cloud& sharp) {
  int matched = 0;
  for (int search = 0; search < kSearches; ++search) {
    const SweepMotion before = motion_;
    ceres::Problem problem;
    for (const Point& feature : sharp) {
      const auto found = line_distance(*edge_target_, feature, before, search > 0);
      if (!found) continue;
      problem.AddResidualBlock(
          new ceres::AutoDiffCostFunction<LineDistance, 3, 3, 3>(new LineDistance(*found)), nullptr,
          motion_.out_of_plane.data(), motion_.in_plane.data());
    }
    matched = problem.NumResidualBlocks();
    if (matched < kMinCorrespondences) return 0;
    solve(problem, motion_.out_of_plane);
    if (has_converged(before, motion_)) break;
  }
  return matched;
}

Cloud Odometry::at_sweep_end(const Cloud& cloud) const {
  const Pose T_end_start = pose_of(motion_).inverse();
  Cloud result;
  for (const Point& point : cloud) {
    result.push_back(moved(T_end_start * pose_of(motion_, sweep_fraction(point)), point));
  }
  return result;
}

void Odometry::add(const Features& features) {
  planes_ = edges_ = 0;
  if (edge_target_) {
    if (edge_target_->size() >= kMinLastEdges && ground_target_->size() >= kMinLastPlanes) {
      planes_ = match_planes(features.flat);
      edges_ = match_edges(features.sharp);
    }
    T_odom_end_ = orthonormalized(T_odom_end_ * pose_of(motion_));
    has_motion_ = true;
  }
  edge_target_.emplace(features.less_sharp);
  ground_target_.emplace(features.less_flat_ground);
}

}  // namespace hqslam::lego_loam

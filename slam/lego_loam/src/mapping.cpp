#include "mapping.h"

#include <ceres/ceres.h>
#include <pcl/kdtree/kdtree_flann.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "hqslam/core/angles.h"

namespace hqslam::lego_loam {

namespace {

constexpr double kMapRadius_m = 50.0;
constexpr double kKeyframeCell_m = 1.0;
constexpr double kKeyframeStep_m = 0.3;
constexpr float kEdgeLeaf_m = 0.2F;
constexpr float kPlaneLeaf_m = 0.4F;
constexpr std::size_t kMinMapEdges = 10;
constexpr std::size_t kMinMapPlanes = 100;
constexpr int kMinCorrespondences = 50;
constexpr int kSearches = 10;
constexpr int kStepsPerSearch = 4;
constexpr int kNeighbours = 5;
constexpr float kReach_m = 1.0F;
constexpr double kSignificant = 3.0;  // ratio of eigenvalues
constexpr double kMaxPlaneOffset_m = 0.2;
constexpr double kWeightFall = 0.9;  // per metre
constexpr double kMinWeight = 0.1;
constexpr double kConverged_m = 0.0005;
constexpr double kConverged_deg = 0.05;

/// weight n . (R p + t - q)
struct PlaneDistance {
  Eigen::Vector3d p;
  Eigen::Vector3d n;
  Eigen::Vector3d q;
  double weight;
  template <typename T>
  bool operator()(const T* rotation, const T* t, T* residual) const {
    const Eigen::Map<const Eigen::Quaternion<T>> R(rotation);
    const Eigen::Map<const Eigen::Matrix<T, 3, 1>> translation(t);
    *residual = weight * n.dot(R * p.cast<T>() + translation - q.cast<T>());
    return true;
  }
};

/// weight (R p + t - q) x u
struct LineDistance {
  Eigen::Vector3d p;
  Eigen::Vector3d u;
  Eigen::Vector3d q;
  double weight;
  template <typename T>
  bool operator()(const T* rotation, const T* t, T* residual) const {
    const Eigen::Map<const Eigen::Quaternion<T>> R(rotation);
    const Eigen::Map<const Eigen::Matrix<T, 3, 1>> translation(t);
    const Eigen::Matrix<T, 3, 1> off = R * p.cast<T>() + translation - q.cast<T>();
    Eigen::Map<Eigen::Matrix<T, 3, 1>> distance(residual);
    distance = weight * off.cross(u.cast<T>());
    return true;
  }
};

/// The map's points of one kind, to be searched.
struct Target {
  explicit Target(const Cloud& cloud_) : cloud(cloud_.makeShared()) {
    if (!cloud->empty()) tree.setInputCloud(cloud);
  }
  /// The five nearest points, a column each, if all are near.
  std::optional<Eigen::Matrix<double, 3, kNeighbours>> neighbours(const Point& p) const {
    std::vector<int> index(kNeighbours);
    std::vector<float> distance_m2(kNeighbours);
    const int found = tree.nearestKSearch(p, kNeighbours, index, distance_m2);
    if (found < kNeighbours || !(distance_m2.back() < kReach_m * kReach_m)) return std::nullopt;
    Eigen::Matrix<double, 3, kNeighbours> points_m;
    for (int i = 0; i < kNeighbours; ++i) points_m.col(i) = position_m((*cloud)[index[i]]);
    return points_m;
  }

  Cloud::Ptr cloud;
  pcl::KdTreeFLANN<Point> tree;
};

/// Mean and, by rising eigenvalue, principal directions of points.
struct Shape {
  explicit Shape(const Eigen::Matrix<double, 3, kNeighbours>& points_m)
      : mean_m(points_m.rowwise().mean()) {
    const Eigen::Matrix<double, 3, kNeighbours> off_m = points_m.colwise() - mean_m;
    principal.compute(off_m * off_m.transpose() / kNeighbours);
  }
  Eigen::Vector3d mean_m;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal;
};

std::optional<LineDistance> line_distance(const Target& map, const Point& feature, const Pose& T) {
  const Point at = moved(T, feature);
  const auto points_m = map.neighbours(at);
  if (!points_m) return std::nullopt;
  const Shape shape(*points_m);
  const Eigen::Vector3d spread = shape.principal.eigenvalues();
  if (!(spread[2] > kSignificant * spread[1])) return std::nullopt;
  const Eigen::Vector3d u = shape.principal.eigenvectors().col(2);
  const double weight = 1.0 - kWeightFall * (position_m(at) - shape.mean_m).cross(u).norm();
  if (!(weight > kMinWeight)) return std::nullopt;
  return LineDistance{position_m(feature), u, shape.mean_m, weight};
}

std::optional<PlaneDistance> plane_distance(const Target& map, const Point& feature,
                                            const Pose& T) {
  const Point at = moved(T, feature);
  const auto points_m = map.neighbours(at);
  if (!points_m) return std::nullopt;
  const Shape shape(*points_m);
  const Eigen::Vector3d spread = shape.principal.eigenvalues();
  if (!(spread[1] > kSignificant * spread[0])) return std::nullopt;
  const Eigen::Vector3d n = shape.principal.eigenvectors().col(0);
  const Eigen::Matrix<double, 3, kNeighbours> off_m = points_m->colwise() - shape.mean_m;
  if ((n.transpose() * off_m).cwiseAbs().maxCoeff() > kMaxPlaneOffset_m) return std::nullopt;
  const double d = std::abs(n.dot(position_m(at) - shape.mean_m));
  const double weight = 1.0 - kWeightFall * d / std::sqrt(position_m(feature).norm());
  if (!(weight > kMinWeight)) return std::nullopt;
  return PlaneDistance{position_m(feature), n, shape.mean_m, weight};
}

}  // namespace

Pose Mapping::T_map_odom() const { return T_map_end_ * T_odom_end_.inverse(); }

std::vector<const Mapping::Keyframe*> Mapping::surrounding() const {
  std::map<std::array<int, 3>, const Keyframe*> latest_in_cell;
  for (const Keyframe& keyframe : keyframes_) {
    if ((keyframe.position_m - T_map_end_.translation()).norm() > kMapRadius_m) continue;
    const Eigen::Vector3i cell =
        (keyframe.position_m / kKeyframeCell_m).array().floor().cast<int>();
    latest_in_cell[{cell.x(), cell.y(), cell.z()}] = &keyframe;
  }
  std::vector<const Keyframe*> result;
  for (const auto& [cell, keyframe] : latest_in_cell) result.push_back(keyframe);
  return result;
}

void Mapping::match(const Cloud& edges, const Cloud& planes) {
  Cloud near_edges;
  Cloud near_planes;
  for (const Keyframe* keyframe : surrounding()) {
    near_edges += keyframe->edges;
    near_planes += keyframe->planes;
  }
  const Target edge_map(thinned(near_edges, kEdgeLeaf_m));
  const Target plane_map(thinned(near_planes, kPlaneLeaf_m));
  if (edge_map.cloud->size() <= kMinMapEdges || plane_map.cloud->size() <= kMinMapPlanes) return;
  for (int search = 0; search < kSearches; ++search) {
    const Pose before = T_map_end_;
    Eigen::Quaterniond rotation(before.linear());
    Eigen::Vector3d translation = before.translation();
    ceres::Problem problem;
    problem.AddParameterBlock(rotation.coeffs().data(), 4, new ceres::EigenQuaternionManifold);
    for (const Point& feature : edges) {
      const auto found = line_distance(edge_map, feature, before);
      if (!found) continue;
      problem.AddResidualBlock(
          new ceres::AutoDiffCostFunction<LineDistance, 3, 4, 3>(new LineDistance(*found)), nullptr,
          rotation.coeffs().data(), translation.data());
    }
    edges_ = problem.NumResidualBlocks();
    for (const Point& feature : planes) {
      const auto found = plane_distance(plane_map, feature, before);
      if (!found) continue;
      problem.AddResidualBlock(
          new ceres::AutoDiffCostFunction<PlaneDistance, 1, 4, 3>(new PlaneDistance(*found)),
          nullptr, rotation.coeffs().data(), translation.data());
    }
    planes_ = problem.NumResidualBlocks() - edges_;
    if (edges_ + planes_ < kMinCorrespondences) {
      edges_ = planes_ = 0;
      return;
    }
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
    options.max_num_iterations = kStepsPerSearch;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    T_map_end_.linear() = rotation.normalized().toRotationMatrix();
    T_map_end_.translation() = translation;
    const Pose step = before.inverse() * T_map_end_;
    if (step.translation().norm() < kConverged_m &&
        degrees(rotation_angle_rad(step)) < kConverged_deg) {
      return;
    }
  }
}

void Mapping::add(const ScanForMap& scan, const Pose& T_odom_end) {
  T_map_end_ = orthonormalized(T_map_odom() * T_odom_end);
  T_odom_end_ = T_odom_end;
  const Cloud edges = thinned(scan.edges, kEdgeLeaf_m);
  const Cloud planes = thinned(scan.planes, kPlaneLeaf_m) + thinned(scan.outliers, kPlaneLeaf_m);
  edges_ = planes_ = 0;
  match(edges, thinned(planes, kPlaneLeaf_m));
  const Eigen::Vector3d position_m = T_map_end_.translation();
  keyframe_ =
      keyframes_.empty() || (position_m - keyframes_.back().position_m).norm() >= kKeyframeStep_m;
  if (!keyframe_) return;
  keyframes_.push_back({position_m, moved(T_map_end_, edges), moved(T_map_end_, planes)});
}

Cloud Mapping::map() const {
  Cloud edges;
  Cloud planes;
  for (const Keyframe& keyframe : keyframes_) {
    edges += keyframe.edges;
    planes += keyframe.planes;
  }
  return thinned(planes, kPlaneLeaf_m) + thinned(edges, kEdgeLeaf_m);
}

}  // namespace hqslam::lego_loam

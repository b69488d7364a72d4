#include "published_mapping.h"

#include <Eigen/Dense>
#include <cmath>
#include <optional>
#include <set>

#include "front_end/voxel_thinning.h"
#include "hqslam/core/angles.h"
#include "map/feature_map.h"

namespace hqslam::slam::as_published {

namespace {

constexpr double kRadius_m = 50.0;
constexpr double kPoseLeaf_m = 1.0;
constexpr double kEdgeLeaf_m = 0.2;
constexpr double kSurfaceLeaf_m = 0.4;
constexpr double kReach_m = 1.0;
constexpr std::size_t kMinMapEdges = 10;
constexpr std::size_t kMinMapSurfaces = 100;
constexpr int kMinMapCorrespondences = 50;
constexpr int kMapIterations = 10;
constexpr double kMinMapEigenvalue = 100.0;
constexpr double kMapWeightFall = 0.9;
constexpr double kMaxPlaneResidual_m = 0.2;
constexpr double kLineShare = 3.0;
constexpr double kMapConverged_deg = 0.05;
constexpr double kMapConverged_m = 0.0005;
constexpr double kKeyframe_m = 0.3;

std::vector<Eigen::Vector3f> thinned(const std::vector<Eigen::Vector3f>& points_m, double leaf_m) {
  std::vector<FeaturePoint> points;
  points.reserve(points_m.size());
  for (const Eigen::Vector3f& point_m : points_m) points.push_back({point_m, 0.0F, 0});
  std::vector<Eigen::Vector3f> result;
  for (const FeaturePoint& point : thin(points, leaf_m)) result.push_back(point.point_m);
  return result;
}

std::optional<WeightedDistance> from_edges(const FeatureMap& map, const Eigen::Vector3d& p) {
  const Neighbours found = map.nearest(p.cast<float>());
  if (found.count < Neighbours::kWanted) return std::nullopt;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3f& q : found.points_m) mean += q.cast<double>() / Neighbours::kWanted;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3f& q : found.points_m) {
    const Eigen::Vector3d off = q.cast<double>() - mean;
    covariance += off * off.transpose() / Neighbours::kWanted;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(covariance);
  if (!(eigen.eigenvalues()(2) > kLineShare * eigen.eigenvalues()(1))) return std::nullopt;
  const WeightedDistance line = distance_from_line(p, mean, mean + eigen.eigenvectors().col(2));
  const double weight = 1.0 - kMapWeightFall * line.distance_m;
  return weight > kMinWeight ? std::optional(weighed(line, weight)) : std::nullopt;
}

std::optional<WeightedDistance> from_surfaces(const FeatureMap& map, const Eigen::Vector3d& p) {
  const Neighbours found = map.nearest(p.cast<float>());
  if (found.count < Neighbours::kWanted) return std::nullopt;
  // n . q = -1: a plane through the map's origin has none, and one near it a poor one.
  Eigen::Matrix<double, Neighbours::kWanted, 3> q;
  for (int i = 0; i < Neighbours::kWanted; ++i) q.row(i) = found.points_m[i].cast<double>();
  const Eigen::Vector3d n =
      q.colPivHouseholderQr().solve(-Eigen::Matrix<double, Neighbours::kWanted, 1>::Ones());
  const double scale = n.norm();
  if (!(scale > 0.0) || !std::isfinite(scale)) return std::nullopt;
  const Eigen::Vector3d normal = n / scale;
  const double offset_m = 1.0 / scale;
  if (((q * normal).array() + offset_m).abs().maxCoeff() > kMaxPlaneResidual_m) return std::nullopt;
  const double distance_m = normal.dot(p) + offset_m;
  // The program's defect: p is in the frame of the map.
  const double weight = 1.0 - kMapWeightFall * std::abs(distance_m) / std::sqrt(p.norm());
  return weight > kMinWeight ? std::optional(weighed({normal, distance_m}, weight)) : std::nullopt;
}

}  // namespace

std::vector<std::size_t> PublishedMapping::surrounding_keyframes() const {
  std::vector<FeaturePoint> near;
  for (std::size_t i = 0; i < keyframes_.size(); ++i) {
    const Eigen::Vector3d position_m = keyframes_[i].T_map_end.translation();
    if ((position_m - T_map_end_.translation()).norm() > kRadius_m) continue;
    near.push_back({position_m.cast<float>(), static_cast<float>(i), 0});
  }
  // Where a place was passed twice, the mean of two numbers is that of a third keyframe.
  std::set<std::size_t> numbers;
  for (const FeaturePoint& pose : thin(near, kPoseLeaf_m)) {
    numbers.insert(static_cast<std::size_t>(pose.time_offset_s));
  }
  return {numbers.begin(), numbers.end()};
}

void PublishedMapping::match(const std::vector<Eigen::Vector3f>& edges_m,
                             const std::vector<Eigen::Vector3f>& surfaces_m) {
  FeatureMap edge_map(kEdgeLeaf_m, kReach_m);
  FeatureMap surface_map(kSurfaceLeaf_m, kReach_m);
  const auto insert = [](FeatureMap& map, const std::vector<Eigen::Vector3f>& points_m,
                         const Pose& T_map_end) {
    std::vector<Eigen::Vector3f> moved_m;
    moved_m.reserve(points_m.size());
    for (const Eigen::Vector3f& p : points_m) {
      moved_m.emplace_back((T_map_end * p.cast<double>()).cast<float>());
    }
    map.insert(moved_m);
  };
  for (const std::size_t i : surrounding_keyframes()) {
    insert(edge_map, keyframes_[i].edges_m, keyframes_[i].T_map_end);
    insert(surface_map, keyframes_[i].surfaces_m, keyframes_[i].T_map_end);
  }
  if (edge_map.size() <= kMinMapEdges || surface_map.size() <= kMinMapSurfaces) return;

  Parameters parameters = parameters_of(T_map_end_);
  PublishedSteps<6> steps(1.0, kMinMapEigenvalue);
  for (int iteration = 0; iteration < kMapIterations; ++iteration) {
    const Pose T_map_end = pose_of(parameters);
    const std::array<Eigen::Matrix3d, 3> dR = rotation_derivatives(parameters);
    int used = 0;
    const auto add = [&](const Eigen::Vector3d& p, const WeightedDistance& match) {
      Parameters row;
      for (int i = 0; i < 3; ++i) row(i) = match.gradient.dot(dR[i] * p);
      row.tail<3>() = match.gradient;
      steps.add(row, match.distance_m);
      ++used;
    };
    for (const Eigen::Vector3f& point_m : edges_m) {
      const Eigen::Vector3d p = point_m.cast<double>();
      if (const auto match = from_edges(edge_map, T_map_end * p)) add(p, *match);
    }
    for (const Eigen::Vector3f& point_m : surfaces_m) {
      const Eigen::Vector3d p = point_m.cast<double>();
      if (const auto match = from_surfaces(surface_map, T_map_end * p)) add(p, *match);
    }
    if (used < kMinMapCorrespondences) break;
    const Parameters step = steps.take();
    parameters += step;
    if (degrees(step.head<3>().norm()) < kMapConverged_deg &&
        step.tail<3>().norm() < kMapConverged_m) {
      break;
    }
  }
  T_map_end_ = pose_of(parameters);
}

void PublishedMapping::add(const LastScan& scan, const std::vector<FeaturePoint>& outliers,
                           const Pose& T_odom_end) {
  T_map_end_ = orthonormalized(T_map_odom() * T_odom_end);
  T_odom_end_ = T_odom_end;
  std::vector<Eigen::Vector3f> outliers_m;
  for (const FeaturePoint& point : outliers) outliers_m.push_back(point.point_m);
  const std::vector<Eigen::Vector3f> edges_m = thinned(scan.edges.points_m, kEdgeLeaf_m);
  std::vector<Eigen::Vector3f> surfaces_m = thinned(scan.surfaces.points_m, kSurfaceLeaf_m);
  const std::vector<Eigen::Vector3f> thin_outliers_m = thinned(outliers_m, kSurfaceLeaf_m);
  surfaces_m.insert(surfaces_m.end(), thin_outliers_m.begin(), thin_outliers_m.end());
  if (!keyframes_.empty()) match(edges_m, thinned(surfaces_m, kSurfaceLeaf_m));
  const bool moved =
      keyframes_.empty() ||
      (T_map_end_.translation() - keyframes_.back().T_map_end.translation()).norm() >= kKeyframe_m;
  if (moved) keyframes_.push_back({T_map_end_, edges_m, surfaces_m});
}

}  // namespace hqslam::slam::as_published

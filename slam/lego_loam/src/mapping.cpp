#include "mapping.h"

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <map>
#include <optional>

namespace hqslam::lego_loam {

namespace {

constexpr double kMapRadius_m = 50.0;
constexpr double kKeyframeCell_m = 1.0;
constexpr double kKeyframeStep_m = 0.3;
constexpr float kEdgeLeaf_m = 0.2F;
constexpr float kPlaneLeaf_m = 0.4F;
constexpr std::size_t kMinMapEdges = 10;
constexpr std::size_t kMinMapPlanes = 100;
constexpr Schedule kSchedule = {10, 4, 50, 0.0005, 0.05};
constexpr int kNeighbours = 5;
constexpr float kReach_m = 1.0F;
constexpr double kSignificant = 3.0;  // ratio of eigenvalues
constexpr double kMaxPlaneOffset_m = 0.2;
constexpr double kWeightFall = 0.9;  // per metre

/// Mean and principal directions of the map's five points nearest to a feature.
struct Shape {
  Eigen::Matrix<double, 3, kNeighbours> from_mean_m;
  Eigen::Vector3d mean_m;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal;  ///< eigenvalues rise

  bool is_line() const {
    return principal.eigenvalues()[2] > kSignificant * principal.eigenvalues()[1];
  }
  bool is_plane() const {
    const auto offset_m = principal.eigenvectors().col(0).transpose() * from_mean_m;
    return principal.eigenvalues()[1] > kSignificant * principal.eigenvalues()[0] &&
           offset_m.cwiseAbs().maxCoeff() <= kMaxPlaneOffset_m;
  }
};

std::optional<Shape> shape_at(const Point& p, const SearchCloud& map) {
  const std::vector<int> index = map.nearest(p, kNeighbours, kReach_m);
  if (index.empty()) return std::nullopt;
  Shape shape;
  for (int i = 0; i < kNeighbours; ++i)
    shape.from_mean_m.col(i) = position_m((*map.cloud)[index[i]]);
  shape.mean_m = shape.from_mean_m.rowwise().mean();
  shape.from_mean_m.colwise() -= shape.mean_m;
  shape.principal.compute(shape.from_mean_m * shape.from_mean_m.transpose());
  return shape;
}

Constraints lines_of(const Cloud& edges, const SearchCloud& map, const Pose& T) {
  Constraints constraints;
  for (const Point& feature : edges) {
    const auto shape = shape_at(moved(T, feature), map);
    if (!shape || !shape->is_line()) continue;
    add_line({position_m(feature), shape->mean_m, {}}, shape->principal.eigenvectors().col(2), T,
             kWeightFall, constraints);
  }
  return constraints;
}

Constraints planes_of(const Cloud& planes, const SearchCloud& map, const Pose& T) {
  Constraints constraints;
  for (const Point& feature : planes) {
    const auto shape = shape_at(moved(T, feature), map);
    if (!shape || !shape->is_plane()) continue;
    add_plane({position_m(feature), shape->mean_m, shape->principal.eigenvectors().col(0)}, T,
              kWeightFall, constraints);
  }
  return constraints;
}

Cloud moved_cloud(const Pose& T, const Cloud& cloud) {
  Cloud result;
  for (const Point& point : cloud) result.push_back(moved(T, point));
  return result;
}

}  // namespace

std::vector<const Mapping::Keyframe*> Mapping::surrounding(
    const Eigen::Vector3d& position_m) const {
  std::map<std::array<double, 3>, const Keyframe*> latest_in_cell;
  for (const Keyframe& keyframe : keyframes_) {
    if ((keyframe.position_m - position_m).norm() > kMapRadius_m) continue;
    const Eigen::Array3d cell = (keyframe.position_m / kKeyframeCell_m).array().floor();
    latest_in_cell[{cell.x(), cell.y(), cell.z()}] = &keyframe;
  }
  std::vector<const Keyframe*> result;
  for (const auto& [cell, keyframe] : latest_in_cell) result.push_back(keyframe);
  return result;
}

Pose Mapping::match(const Cloud& edges, const Cloud& planes, const Pose& T_map_end) {
  Cloud near_edges;
  Cloud near_planes;
  for (const Keyframe* keyframe : surrounding(T_map_end.translation())) {
    near_edges += keyframe->edges;
    near_planes += keyframe->planes;
  }
  const SearchCloud edge_map(thinned(near_edges, kEdgeLeaf_m));
  const SearchCloud plane_map(thinned(near_planes, kPlaneLeaf_m));
  if (edge_map.cloud->size() <= kMinMapEdges || plane_map.cloud->size() <= kMinMapPlanes) {
    return T_map_end;
  }
  PoseParameters pose = parameters_of(T_map_end);
  const int found = align(pose, Free::kAll, kSchedule, [&](const PoseParameters& now, int) {
    Constraints all = lines_of(edges, edge_map, pose_of(now));
    const Constraints of_planes = planes_of(planes, plane_map, pose_of(now));
    result_.edges = static_cast<int>(all.size()) / kPerLine;
    all.insert(all.end(), of_planes.begin(), of_planes.end());
    return all;
  });
  if (found == 0) result_.edges = 0;
  result_.planes = found - kPerLine * result_.edges;
  return pose_of(pose);
}

const MappingResult& Mapping::add(const ScanForMap& scan, const Pose& T_odom_end) {
  result_.edges = result_.planes = 0;
  const Cloud edges = thinned(scan.edges, kEdgeLeaf_m);
  const Cloud planes = thinned(scan.planes, kPlaneLeaf_m) + thinned(scan.outliers, kPlaneLeaf_m);
  const Pose T_map_end =
      match(edges, thinned(planes, kPlaneLeaf_m), result_.T_map_odom * T_odom_end);
  result_.T_map_odom = orthonormalized(T_map_end * T_odom_end.inverse());
  const Eigen::Vector3d end_m = T_map_end.translation();
  result_.keyframe =
      keyframes_.empty() || (end_m - keyframes_.back().position_m).norm() > kKeyframeStep_m;
  if (result_.keyframe) {
    keyframes_.push_back({end_m, moved_cloud(T_map_end, edges), moved_cloud(T_map_end, planes)});
  }
  return result_;
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

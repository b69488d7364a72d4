#include "map/recent_features.h"

#include "front_end/voxel_thinning.h"
#include "hqslam/slam/motion_correction.h"

namespace hqslam::slam {

namespace {

constexpr double kEdgeLeaf_m = 0.4;
constexpr double kPlanarLeaf_m = 0.8;

/// Every so many-th point, so that max_points are left.
std::vector<FeaturePoint> every_nth(const std::vector<FeaturePoint>& points,
                                    std::size_t max_points) {
  if (points.size() <= max_points) return points;
  std::vector<FeaturePoint> result;
  result.reserve(max_points);
  for (std::size_t i = 0; i < max_points; ++i) {
    result.push_back(points[i * points.size() / max_points]);
  }
  return result;
}

}  // namespace

void RecentFeatures::add(const MapFeatures& features, const Pose& T_map_sensor,
                         const Twist& velocity) {
  scans_.push_back({T_map_sensor, motion_corrected(features.edges, velocity),
                    motion_corrected(features.ground_to_locate, velocity),
                    motion_corrected(features.surfaces_to_locate, velocity)});
  if (scans_.size() > max_scans_) scans_.pop_front();
}

void RecentFeatures::correct(const Pose& T_corrected_map) {
  for (Scan& scan : scans_) scan.T_map_sensor = T_corrected_map * scan.T_map_sensor;
}

std::vector<FeaturePoint> RecentFeatures::gathered(std::vector<Eigen::Vector3f> Scan::*kind,
                                                   double radius_m, double leaf_m,
                                                   std::size_t max_points) const {
  std::vector<FeaturePoint> result;
  const auto radius = static_cast<float>(radius_m);
  for (const Scan& scan : scans_) {
    const Eigen::Isometry3f T_last_scan =
        (scans_.back().T_map_sensor.inverse() * scan.T_map_sensor).cast<float>();
    for (const Eigen::Vector3f& point_m : scan.*kind) {
      const Eigen::Vector3f moved_m = T_last_scan * point_m;
      if (moved_m.norm() <= radius) result.push_back({moved_m, 0.0F, 0});
    }
  }
  return every_nth(thin(result, leaf_m), max_points);
}

MapFeatures RecentFeatures::about_last(double radius_m, std::size_t max_points) const {
  MapFeatures result;
  result.edges = gathered(&Scan::edges_m, radius_m, kEdgeLeaf_m, max_points);
  result.ground_to_locate = gathered(&Scan::ground_m, radius_m, kPlanarLeaf_m, max_points);
  result.surfaces_to_locate = gathered(&Scan::surfaces_m, radius_m, kPlanarLeaf_m, max_points);
  return result;
}

}  // namespace hqslam::slam

#include "map/recent_features.h"

#include "front_end/motion_correction.h"
#include "front_end/voxel_thinning.h"

namespace hqslam::slam {

namespace {

constexpr float kRadius_m = 35.0F;
constexpr std::size_t kMaxPoints = 800;
constexpr double kEdgeLeaf_m = 0.4;
constexpr double kPlanarLeaf_m = 0.8;

/// Evenly chosen points, kMaxPoints at most.
std::vector<FeaturePoint> every_nth(const std::vector<FeaturePoint>& points) {
  if (points.size() <= kMaxPoints) return points;
  std::vector<FeaturePoint> result;
  result.reserve(kMaxPoints);
  for (std::size_t i = 0; i < kMaxPoints; ++i) {
    result.push_back(points[i * points.size() / kMaxPoints]);
  }
  return result;
}

}  // namespace

void RecentFeatures::add(const MapFeatures& features, const Pose& T_map_sensor,
                         const ScanMotion& motion) {
  scans_.push_back({T_map_sensor, motion_corrected(features.edges, motion),
                    motion_corrected(features.ground_to_register, motion),
                    motion_corrected(features.surfaces_to_register, motion)});
  if (scans_.size() > max_scans_) scans_.pop_front();
}

void RecentFeatures::correct(const Pose& T_corrected_map) {
  for (Scan& scan : scans_) scan.T_map_sensor = T_corrected_map * scan.T_map_sensor;
}

std::vector<FeaturePoint> RecentFeatures::gathered(std::vector<Eigen::Vector3f> Scan::*kind,
                                                   double leaf_m) const {
  std::vector<FeaturePoint> result;
  for (const Scan& scan : scans_) {
    const Eigen::Isometry3f T_last_scan =
        (scans_.back().T_map_sensor.inverse() * scan.T_map_sensor).cast<float>();
    for (const Eigen::Vector3f& point_m : scan.*kind) {
      const Eigen::Vector3f moved_m = T_last_scan * point_m;
      if (moved_m.norm() <= kRadius_m) result.push_back({moved_m, 0.0F, 0});
    }
  }
  return every_nth(thin(result, leaf_m));
}

MapFeatures RecentFeatures::about_last() const {
  MapFeatures result;
  result.edges = gathered(&Scan::edges_m, kEdgeLeaf_m);
  result.ground_to_register = gathered(&Scan::ground_m, kPlanarLeaf_m);
  result.surfaces_to_register = gathered(&Scan::surfaces_m, kPlanarLeaf_m);
  // As most surfaces stand.
  for (FeaturePoint& point : result.surfaces_to_register) point.slope = result.up.cast<float>();
  return result;
}

}  // namespace hqslam::slam

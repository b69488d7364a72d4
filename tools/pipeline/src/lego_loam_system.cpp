#include "hqslam/core/error.h"
#include "slam_system.h"

#ifdef HQSLAM_LEGO_LOAM

#include <chrono>
#include <limits>

#include "hqslam/lego_loam/lego_loam.h"

namespace hqslam::pipeline {
namespace {

using slam::Status;

/// It estimates no covariance, so none is claimed: variances are infinite. A scan that is not
/// registered with the map keeps the odometry's motion.
class LegoLoamSystem : public SlamSystem {
 public:
  explicit LegoLoamSystem(const SensorModel& sensor) : lego_loam_(sensor) {}

  slam::ScanReport process(const OrganizedCloud& cloud, double stamp_s, slam::ScanTrace*) override {
    const auto start = std::chrono::steady_clock::now();
    const lego_loam::ScanReport found = lego_loam_.process(cloud, stamp_s);
    segment_of_scan_.push_back(0);
    slam::ScanReport report;
    report.stamp_s = found.stamp_s;
    report.T_odom_sensor = found.T_odom_sensor;
    report.T_map_sensor = found.T_map_sensor;
    report.covariance.diagonal().setConstant(std::numeric_limits<double>::infinity());
    report.velocity_covariance = report.covariance;
    const bool is_first = segment_of_scan_.size() == 1;
    const bool has_odometry = found.odometry_planes > 0 && found.odometry_edges > 0;
    report.odometry_status = has_odometry || is_first ? Status::kOk : Status::kTooFewFeatures;
    for (const float range_m : cloud.range_m) report.returns += range_m > 0.0F ? 1 : 0;
    report.ground_points = found.ground_points;
    report.edge_features = found.edge_features;
    report.planar_features = found.planar_features;
    report.edge_correspondences = found.mapping_edges;
    report.planar_correspondences = found.mapping_planes;
    report.keyframe = found.keyframe;
    report.times.total_s =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return report;
  }
  const Trajectory& trajectory() const override { return lego_loam_.trajectory(); }
  const std::vector<std::size_t>& segment_of_scan() const override { return segment_of_scan_; }
  std::vector<Eigen::Vector3f> map_points_m(std::optional<std::size_t>,
                                            std::vector<float>* intensity) const override {
    if (intensity != nullptr) intensity->clear();
    return lego_loam_.map_points_m();
  }
  slam::SavedMap saved_map() const override {
    throw Error(
        "saved map: expected hqslam's SLAM, found LeGO-LOAM, which recognizes no places; save the "
        "map of a run of hqslam's");
  }

 private:
  lego_loam::LegoLoam lego_loam_;
  std::vector<std::size_t> segment_of_scan_;
};

}  // namespace

std::unique_ptr<SlamSystem> lego_loam_system(const SensorModel& sensor,
                                             const PipelineOptions& options) {
  if (!options.map) return std::make_unique<LegoLoamSystem>(sensor);
  throw Error(
      "LeGO-LOAM: cannot be located in a saved map; leave the map out, or use hqslam's own SLAM");
}

}  // namespace hqslam::pipeline

#else

namespace hqslam::pipeline {

std::unique_ptr<SlamSystem> lego_loam_system(const SensorModel&, const PipelineOptions&) {
  throw Error(
      "LeGO-LOAM: this hqslam was built without PCL, which it needs; build with "
      "HQSLAM_BUILD_LEGO_LOAM, or use hqslam's own SLAM");
}

}  // namespace hqslam::pipeline

#endif

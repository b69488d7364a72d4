#include "hqslam/lego_loam/lego_loam.h"

#include <optional>

#include "check_option.h"
#include "feature_extraction.h"
#include "front_end/scan_check.h"
#include "mapping.h"
#include "odometry.h"
#include "segmentation.h"

namespace hqslam::lego_loam {

namespace {

constexpr int kOdometryPerMappingScan = 2;
constexpr double kMappingInterval_s = 0.3;

}  // namespace

struct LegoLoam::Implementation {
  explicit Implementation(const SensorModel& sensor_)
      : sensor(slam::validated(sensor_)), segmentation(sensor) {}

  ScanReport process(const OrganizedCloud& cloud, double stamp_s, ScanTrace* trace) {
    const SegmentedScan scan = segmentation.segment(cloud);
    const Features features = extract_features(scan, cloud.columns);
    const OdometryResult& moved = odometry.add(features);
    const bool mapping_is_due = moved.has_motion && is_mapping_due(stamp_s);
    if (mapping_is_due) {
      mapped =
          mapping.add({at_sweep_end(features.less_sharp, moved.motion),
                       at_sweep_end(Cloud(features.less_flat_ground) + features.less_flat_cluster,
                                    moved.motion),
                       at_sweep_end(scan.outliers, moved.motion)},
                      moved.T_odom_end);
    }
    // The stamp is the middle of the sweep; a scan without times is captured at its end.
    const double at_stamp = cloud.time_offset_s.empty() ? 1.0 : 0.5;
    const Pose T_end_stamp = pose_of(moved.motion).inverse() * pose_of(moved.motion, at_stamp);
    ScanReport report;
    report.stamp_s = stamp_s;
    report.T_odom_sensor = orthonormalized(moved.T_odom_end * T_end_stamp);
    report.T_map_sensor = orthonormalized(mapped.T_map_odom * report.T_odom_sensor);
    report.ground_points = scan.ground_points;
    report.clusters = scan.clusters;
    report.edge_features = static_cast<int>(features.sharp.size());
    report.planar_features = static_cast<int>(features.flat.size());
    report.odometry_edges = moved.edges;
    report.odometry_planes = moved.planes;
    if (mapping_is_due) {
      report.mapping_edges = mapped.edges;
      report.mapping_planes = mapped.planes;
      report.keyframe = mapped.keyframe;
    }
    // Of the first scan the motion is known only with the second.
    if (trajectory.size() == 1) trajectory.front().T_map_sensor = T_end_stamp;
    trajectory.push_back({stamp_s, report.T_map_sensor});
    if (trace != nullptr) {
      *trace = {scan.label, features.kind, pose_of(moved.motion), moved.T_odom_end,
                mapped.T_map_odom * moved.T_odom_end};
    }
    return report;
  }

  bool is_mapping_due(double stamp_s) {
    constexpr double kRounding_s = 1e-6;
    if (scans_with_motion++ % kOdometryPerMappingScan != 0) return false;
    if (mapped_s && std::abs(stamp_s - *mapped_s) < kMappingInterval_s - kRounding_s) return false;
    mapped_s = stamp_s;
    return true;
  }

  SensorModel sensor;
  Segmentation segmentation;
  Odometry odometry;
  Mapping mapping;
  MappingResult mapped;
  int scans_with_motion = 0;
  std::optional<double> mapped_s;
  Trajectory trajectory;
};

LegoLoam::LegoLoam(const SensorModel& sensor)
    : implementation_(std::make_unique<Implementation>(sensor)) {}
LegoLoam::~LegoLoam() = default;
LegoLoam::LegoLoam(LegoLoam&&) noexcept = default;
LegoLoam& LegoLoam::operator=(LegoLoam&&) noexcept = default;

ScanReport LegoLoam::process(const OrganizedCloud& cloud, double stamp_s, ScanTrace* trace) {
  slam::check(cloud, stamp_s, implementation_->sensor);
  const std::optional<OrganizedCloud> emptied = slam::without_unsound(cloud);
  return implementation_->process(emptied ? *emptied : cloud, stamp_s, trace);
}

const Trajectory& LegoLoam::trajectory() const { return implementation_->trajectory; }

std::vector<Eigen::Vector3f> LegoLoam::map_points_m() const {
  std::vector<Eigen::Vector3f> points_m;
  for (const Point& point : implementation_->mapping.map()) {
    points_m.push_back(point.getVector3fMap());
  }
  return points_m;
}

}  // namespace hqslam::lego_loam

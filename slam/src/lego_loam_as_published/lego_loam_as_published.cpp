#include "hqslam/slam/lego_loam_as_published.h"

#include <optional>

#include "front_end/scan_check.h"
#include "published_features.h"
#include "published_mapping.h"
#include "published_odometry.h"
#include "segmented_scan.h"

namespace hqslam::slam {

namespace {

constexpr int kOdometryPerMappingScan = 2;
constexpr double kMappingInterval_s = 0.3;

SensorModel checked_sensor(const SensorModel& sensor) {
  hqslam::validate(sensor);
  return sensor;
}

}  // namespace

struct LegoLoamAsPublished::Implementation {
  explicit Implementation(const SensorModel& sensor_)
      : sensor(checked_sensor(sensor_)), projection(sensor), odometry(sensor.scan_period_s) {}

  Pose process(const OrganizedCloud& cloud, double stamp_s) {
    const as_published::SegmentedScan scan = projection.segment(cloud);
    odometry.add(as_published::published_features(scan));
    if (!odometry.has_motion()) {
      trajectory.push_back({stamp_s, Pose::Identity()});
      return Pose::Identity();
    }
    if (scans_with_motion++ % kOdometryPerMappingScan == 0) map_if_due(scan, stamp_s);
    // The stamp is half a sweep before the end; of the first scan that is known only now.
    const Pose T_end_stamp = as_published::pose_of(odometry.motion()).inverse() *
                             as_published::pose_of(0.5 * odometry.motion());
    if (trajectory.size() == 1) trajectory.front().T_map_sensor = T_end_stamp;
    const Pose T_map_sensor =
        orthonormalized(mapping.T_map_odom() * odometry.T_odom_end() * T_end_stamp);
    trajectory.push_back({stamp_s, T_map_sensor});
    return T_map_sensor;
  }

  void map_if_due(const as_published::SegmentedScan& scan, double stamp_s) {
    constexpr double kRounding_s = 1e-6;
    if (mapped_s && stamp_s - *mapped_s < kMappingInterval_s - kRounding_s) return;
    mapping.add(odometry.last(), scan.outliers, odometry.T_odom_end());
    mapped_s = stamp_s;
  }

  SensorModel sensor;
  as_published::ImageProjection projection;
  as_published::PublishedOdometry odometry;
  as_published::PublishedMapping mapping;
  int scans_with_motion = 0;
  std::optional<double> mapped_s;
  Trajectory trajectory;
};

LegoLoamAsPublished::LegoLoamAsPublished(const SensorModel& sensor)
    : implementation_(std::make_unique<Implementation>(sensor)) {}
LegoLoamAsPublished::~LegoLoamAsPublished() = default;
LegoLoamAsPublished::LegoLoamAsPublished(LegoLoamAsPublished&&) noexcept = default;
LegoLoamAsPublished& LegoLoamAsPublished::operator=(LegoLoamAsPublished&&) noexcept = default;

Pose LegoLoamAsPublished::process(const OrganizedCloud& cloud, double stamp_s) {
  check(cloud, stamp_s, implementation_->sensor);
  return all_sound(cloud) ? implementation_->process(cloud, stamp_s)
                          : implementation_->process(without_unsound(cloud), stamp_s);
}

const Trajectory& LegoLoamAsPublished::trajectory() const { return implementation_->trajectory; }

}  // namespace hqslam::slam

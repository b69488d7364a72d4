#include "raw_points.h"

#include <utility>

namespace hqslam {

namespace {

/// No LiDAR takes so long for one scan.
constexpr double kMaxScanDuration_s = 1.0;

}  // namespace

bool RawPoints::add(double x_m, double y_m, double z_m) {
  const Eigen::Vector3f point_m(static_cast<float>(x_m), static_cast<float>(y_m),
                                static_cast<float>(z_m));
  if (!point_m.allFinite() || point_m.isZero(0.0F)) {
    ++scan.invalid_points;
    return false;
  }
  scan.points_m.push_back(point_m);
  return true;
}

Scan scan_of(RawPoints points, const SensorModel* sensor, const std::string& path) {
  const double period_s = sensor != nullptr ? sensor->scan_period_s : kMaxScanDuration_s;
  if (auto times = point_times(points.time, period_s, path)) {
    points.scan.time_offset_s = std::move(times->offset_s);
    if (times->absolute) points.scan.stamp_s = times->middle_s;
  }
  if (sensor != nullptr && !points.ring.empty()) {
    points.scan.row = rows_from_rings(points.ring, points.scan, *sensor, path, points.ring_name);
  }
  return std::move(points.scan);
}

}  // namespace hqslam

#include "dense_map/mapped_scan.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hqslam/core/error.h"

namespace hqslam::slam {

namespace {

constexpr int kEntries = 4096;

}  // namespace

MappedScan::MappedScan(const OrganizedCloud& cloud, const SensorPath& path) : cloud_(cloud) {
  check_shape(cloud);
  if (!path.at(0.0).matrix().allFinite()) {
    throw Error("dense map: expected a finite pose of a scan, found one that is not; leave it out");
  }
  double last_s = 0.0;
  for (std::size_t pixel = 0; pixel < cloud.time_offset_s.size(); ++pixel) {
    const double time_s = cloud.time_offset_s[pixel];
    if (!(cloud.range_m[pixel] > 0.0F) || !std::isfinite(time_s)) continue;
    first_s_ = std::min(first_s_, time_s);
    last_s = std::max(last_s, time_s);
  }
  per_s_ = last_s > first_s_ ? (kEntries - 1) / (last_s - first_s_) : 0.0;
  const int entries = per_s_ > 0.0 ? kEntries : 1;
  T_map_sensor_.resize(static_cast<std::size_t>(entries));
#pragma omp parallel for schedule(static)
  for (int i = 0; i < entries; ++i) {
    T_map_sensor_[static_cast<std::size_t>(i)] =
        path.at(entries == 1 ? 0.0 : first_s_ + i / per_s_);
  }
}

const Pose& MappedScan::T_map_sensor(std::size_t pixel) const {
  if (T_map_sensor_.size() == 1) return T_map_sensor_.front();
  const double entry = std::round((cloud_.time_offset_s[pixel] - first_s_) * per_s_);
  return T_map_sensor_[static_cast<std::size_t>(entry)];
}

std::vector<Eigen::Vector3d> MappedScan::points_in_map_m(double max_range_m) const {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::vector<Eigen::Vector3d> points_m(cloud_.range_m.size(), Eigen::Vector3d::Constant(kNone));
#pragma omp parallel for schedule(static)
  for (std::size_t pixel = 0; pixel < points_m.size(); ++pixel) {
    if (!has_return(pixel) || cloud_.range_m[pixel] > max_range_m) continue;
    points_m[pixel] = point_in_map_m(pixel);
  }
  return points_m;
}

}  // namespace hqslam::slam

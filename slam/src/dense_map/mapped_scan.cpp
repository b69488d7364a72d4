#include "dense_map/mapped_scan.h"

#include <algorithm>

#include "hqslam/core/error.h"

namespace hqslam::slam {

namespace {

constexpr int kEntries = 4096;

void check_shape(const OrganizedCloud& cloud) {
  const std::size_t pixels = static_cast<std::size_t>(std::max(cloud.rows, 0)) *
                             static_cast<std::size_t>(std::max(cloud.columns, 0));
  const auto fits = [&](std::size_t size) { return size == 0 || size == pixels; };
  if (cloud.points_m.size() == pixels && cloud.range_m.size() == pixels &&
      fits(cloud.time_offset_s.size()) && fits(cloud.confidence.size()) &&
      fits(cloud.intensity.size())) {
    return;
  }
  throw Error(
      "dense map: scan of {}x{} pixels has {} points, {} ranges, {} capture times, {} confidences "
      "and {} intensities: give each pixel its own, of the last three or none",
      cloud.rows, cloud.columns, cloud.points_m.size(), cloud.range_m.size(),
      cloud.time_offset_s.size(), cloud.confidence.size(), cloud.intensity.size());
}

}  // namespace

MappedScan::MappedScan(const OrganizedCloud& cloud, const SensorPath& path) : cloud_(cloud) {
  check_shape(cloud);
  if (!path.at(0.0).matrix().allFinite()) {
    throw Error("dense map: the pose of a scan is not finite; leave the scan out");
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

}  // namespace hqslam::slam

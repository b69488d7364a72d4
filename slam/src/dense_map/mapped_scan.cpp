#include "dense_map/mapped_scan.h"

#include <algorithm>

#include "hqslam/core/error.h"

namespace hqslam::slam {

namespace {

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

void check_mapped_scan(const OrganizedCloud& cloud, const SensorPath& path) {
  check_shape(cloud);
  if (path.at(0.0).matrix().allFinite()) return;
  throw Error("dense map: the pose of a scan is not finite; leave the scan out");
}

}  // namespace hqslam::slam

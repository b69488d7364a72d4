#include "files/point_files.h"

#include <algorithm>

#include "hqslam/core/cloud_file.h"
#include "hqslam/core/kitti_bin.h"

namespace hqslam {

namespace {

RawPoints read_by_name(const std::string& path) {
  if (path.ends_with(".pcd")) return read_pcd_points(path);
  if (path.ends_with(".ply")) return read_ply_points(path);
  if (path.ends_with(".bin")) return RawPoints(read_kitti_bin(path));
  return read_text_points(path);
}

}  // namespace

RawPoints read_point_file(const std::string& path) {
  RawPoints points = read_by_name(path);
  // Formats with a place for intensities have it also where none are known.
  std::vector<float>& intensity = points.scan.intensity;
  if (std::ranges::count(intensity, 0.0F) == std::ssize(intensity)) intensity.clear();
  return points;
}

Scan read_cloud(const std::string& path) { return scan_of(read_point_file(path), nullptr, path); }

Scan read_cloud(const std::string& path, const SensorModel& sensor) {
  return scan_of(read_point_file(path), &sensor, path);
}

}  // namespace hqslam

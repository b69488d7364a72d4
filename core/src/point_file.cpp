#include <algorithm>

#include "hqslam/core/kitti_bin.h"
#include "point_files.h"

namespace hqslam {

namespace {

RawPoints read_by_name(const std::string& path) {
  if (path.ends_with(".pcd")) return read_pcd_points(path);
  if (path.ends_with(".ply")) return read_ply_points(path);
  if (path.ends_with(".las") || path.ends_with(".laz")) return read_las_points(path);
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

}  // namespace hqslam

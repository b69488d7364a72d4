#include "hqslam/core/kitti_bin.h"
#include "point_files.h"

namespace hqslam {

RawPoints read_point_file(const std::string& path) {
  if (path.ends_with(".pcd")) return read_pcd_points(path);
  if (path.ends_with(".ply")) return read_ply_points(path);
  if (path.ends_with(".bin")) return RawPoints(read_kitti_bin(path));
  return read_text_points(path);
}

}  // namespace hqslam

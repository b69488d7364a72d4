#include "run/dense_map_output.h"

#include <system_error>

#include "files/result_folder.h"
#include "hqslam/core/whole_file.h"
#include "report/cloud_picture.h"

namespace hqslam::tools {
namespace {

namespace fs = std::filesystem;

constexpr int kPictureColumns = 1600;
constexpr int kAboveRows = 1200;
constexpr int kPerspectiveRows = 900;

}  // namespace

DenseMapPictures pictures_of(const DenseMapRun& run, const Trajectory& path) {
  std::vector<Eigen::Vector3f> points_m;
  points_m.reserve(run.points.size());
  for (const slam::DenseMapPoint& point : run.points) points_m.push_back(point.point_m);
  const CloudScene scene{points_m, path, run.voxel_m};
  return {cloud_from_above(scene, kAboveRows, kPictureColumns),
          cloud_in_perspective(scene, kPerspectiveRows, kPictureColumns)};
}

void guard_dense_map(const fs::path& folder, const Paths& inputs) {
  const auto is_own = [&](const char* name) {
    return has_marker((folder / name).string(), "written by hqslam");
  };
  guard_results(folder, kDenseMapFiles, is_own("dense_map.ply"),
                "there is no dense map of hqslam beside it", inputs);
  if (fs::exists(folder / "dense_map.pcd") && !is_own("dense_map.pcd")) {
    guard_results(folder, {kDenseMapFiles, 1}, false, "was not written by hqslam", inputs);
  }
}

void remove_dense_map(const fs::path& folder) {
  std::error_code ignored;
  // The .ply, by which the others are known as ours, goes last and comes first.
  for (const char* name :
       {kDenseMapFiles[0], kDenseMapFiles[2], kDenseMapFiles[3], kDenseMapFiles[1]}) {
    fs::remove(folder / name, ignored);
    fs::remove(folder / (std::string(name) + ".part"), ignored);  // of a run that was killed
  }
}

void write_dense_map(const DenseMapRun& run, const DenseMapPictures& pictures,
                     const fs::path& folder) {
  make_result_folder(folder);
  remove_dense_map(folder);
  replace_file((folder / "dense_map.ply").string(),
               [&](const std::string& path) { slam::write_dense_map_ply(run.points, path); });
  replace_file((folder / "dense_map.pcd").string(),
               [&](const std::string& path) { slam::write_dense_map_pcd(run.points, path); });
  replace_file((folder / "dense_map_above.png").string(),
               [&](const std::string& path) { write_png(pictures.above, path); });
  replace_file((folder / "dense_map_perspective.png").string(),
               [&](const std::string& path) { write_png(pictures.perspective, path); });
}

}  // namespace hqslam::tools

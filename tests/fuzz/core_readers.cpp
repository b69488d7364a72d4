#include "hqslam/core/cloud_file.h"
#include "hqslam/core/npz.h"
#include "hqslam/core/projection.h"
#include "hqslam/core/trajectory.h"
#include "input_file.h"
#include "made_images.h"

namespace hqslam::fuzz {
namespace {

void read_poses(const std::string& path, bool with_stamps) {
  const TrajectoryFile file = read_trajectory_file(path);
  if (file.has_stamps == with_stamps) path_length_m(file.poses);
}

}  // namespace

void npz(Bytes input) {
  constexpr std::int64_t kLargestBytes = 1 << 20;
  read_npz(as_file(input, ".npz"), kLargestBytes);
}

void pcd(Bytes input) {
  // Few columns: the readers are to be fed, not the projection.
  static const SensorModel sensor = test::preset_with("vlp-16", 32);
  project(read_cloud(as_whole_file(input, ".pcd"), sensor), sensor);
}

void sensor_json(Bytes input) { validate(read_sensor_json(as_whole_file(input, ".json"))); }

void tum(Bytes input) { read_poses(as_whole_file(input, ".tum"), true); }

void kitti(Bytes input) { read_poses(as_whole_file(input, ".kitti"), false); }

}  // namespace hqslam::fuzz

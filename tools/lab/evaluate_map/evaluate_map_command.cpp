#include <Eigen/Core>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <unordered_set>
#include <vector>

#include "hqslam/core/cloud_file.h"
#include "hqslam/core/error.h"
#include "hqslam/evaluation/cloud_error.h"
#include "hqslam/evaluation/trajectory_error.h"
#include "hqslam/sim/drive.h"
#include "laboratory.h"
#include "recording/recording_choice.h"
#include "terminal/command_options.h"
#include "terminal/terminal.h"

namespace hqslam::tools {
namespace {

namespace fs = std::filesystem;

struct EvaluateMapOptions {
  std::vector<std::string> maps;
  std::string drive;
};

constexpr double kSample_m = 0.1;
constexpr double kFar_m = 0.3;

/// A key of the cube of kSample_m that contains a point, unique within 2^20 cubes.
std::uint64_t sample_key(const Eigen::Vector3f& point_m) {
  const auto part = [](float metres) {
    return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(metres / kSample_m))) &
           0x1FFFFFU;
  };
  return part(point_m.x()) << 42U | part(point_m.y()) << 21U | part(point_m.z());
}

double share_within(const std::vector<float>& distances_m, double limit_m) {
  const auto near = std::ranges::count_if(distances_m, [&](float d_m) { return d_m <= limit_m; });
  return static_cast<double>(near) / static_cast<double>(distances_m.size());
}

double harmonic_mean(double a, double b) { return a + b > 0.0 ? 2.0 * a * b / (a + b) : 0.0; }

/// The surface visible to the sensor along a drive (DriveSimulator::next_visible), one sample per
/// voxel of 0.1 m: the first that a beam meets. Map frame.
std::vector<Eigen::Vector3f> visible_surface_m(sim::DriveSimulator simulator) {
  std::vector<Eigen::Vector3f> samples_m;
  std::unordered_set<std::uint64_t> taken;
  while (const auto visible = simulator.next_visible()) {
    for (const Eigen::Vector3f& point_m : *visible) {
      if (taken.insert(sample_key(point_m)).second) samples_m.push_back(point_m);
    }
  }
  return samples_m;
}

/// T_truth_map from the poses in the folder of a map: the mean of T_truth_sensor T_map_sensor^-1
/// over the scans. It uses their rotations too, because the positions of a straight drive do not
/// determine its roll.
std::optional<Pose> alignment_of(const fs::path& map, const TrajectoryFile& truth) {
  constexpr double kSameTime_s = 0.01;
  const std::string path =
      file_of_drive(fs::absolute(map).parent_path().string(), "trajectory.tum");
  if (path.empty()) return std::nullopt;
  const Trajectory trajectory = read_tum(path);
  const PosePairs pairs = associate(trajectory, truth.poses, kSameTime_s);
  if (pairs.estimate.empty()) {
    throw Error(
        "{}: expected poses at the stamps of the drive's scans, found none; give a map of this "
        "drive",
        path);
  }
  Eigen::Matrix3d rotations = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < pairs.estimate.size(); ++i) {
    rotations += truth.poses[pairs.reference[i]].T_map_sensor.linear() *
                 trajectory[pairs.estimate[i]].T_map_sensor.linear().transpose();
  }
  // The rotation nearest to the sum.
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(rotations, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Pose T_truth_map = Pose::Identity();
  T_truth_map.linear() = svd.matrixU() * svd.matrixV().transpose();
  Eigen::Vector3d offset_m = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < pairs.estimate.size(); ++i) {
    offset_m += truth.poses[pairs.reference[i]].T_map_sensor.translation() -
                T_truth_map.linear() * trajectory[pairs.estimate[i]].T_map_sensor.translation();
  }
  T_truth_map.translation() = offset_m / static_cast<double>(pairs.estimate.size());
  return T_truth_map;
}

std::string file_of(const std::string& drive, const char* name) {
  const std::string path = file_of_drive(drive, name);
  if (path.empty()) {
    throw Error("{}: expected {} in it, found none; give a folder written by hqslam-lab simulate",
                drive, name);
  }
  return path;
}

/// The points of a dense map, aligned with the truth if there are poses in its folder.
struct AlignedMap {
  std::vector<Eigen::Vector3f> points_m;
  bool is_aligned = false;
};

AlignedMap aligned_map(const std::string& path, const TrajectoryFile& truth) {
  const fs::path file = fs::is_directory(path) ? fs::path(path) / "dense_map.pcd" : fs::path(path);
  std::vector<Eigen::Vector3f> points_m = read_cloud(file.string()).points_m;
  const std::optional<Pose> T_truth_map = alignment_of(file, truth);
  for (Eigen::Vector3f& point_m : points_m) {
    if (T_truth_map) point_m = (*T_truth_map * point_m.cast<double>()).cast<float>();
  }
  return {std::move(points_m), T_truth_map.has_value()};
}

/// Source of the measures: Knapitsch et al., "Tanks and Temples", 2017 (precision and recall of
/// surfaces within a distance).
void evaluate_dense_maps(const std::vector<std::string>& paths, const sim::DriveSpec& spec,
                         const SensorModel& sensor, const TrajectoryFile& truth) {
  const std::vector<Eigen::Vector3f> visible_m = visible_surface_m({spec, sensor});
  sim::DriveSimulator surface(spec, sensor);
  to_stdout("{} visible samples of the true surface; shares in percent\n", visible_m.size());
  to_stdout("{:>10}{:>18}{:>9}{:>18}{:>16}\n", "points", "accuracy", "far", "complete", "F1");
  to_stdout("{:>10}{:>9}{:>9}{:>9}{:>9}{:>9}{:>8}{:>8}\n", "", "0.1 m", "0.2 m", "0.3 m", "0.1 m",
            "0.2 m", "0.1 m", "0.2 m");
  for (const std::string& path : paths) {
    const auto [points_m, is_aligned] = aligned_map(path, truth);
    if (points_m.empty() || visible_m.empty()) {
      throw Error(
          "expected points in the map and on the visible surface, found none; give a map of the "
          "drive");
    }
    const std::vector<float> to_surface_m = surface.distances_to_surface_m(points_m, kFar_m);
    const std::vector<float> to_map_m = nearest_distances_m(visible_m, points_m);
    const double accuracy_10_cm = share_within(to_surface_m, 0.1);
    const double accuracy_20_cm = share_within(to_surface_m, 0.2);
    const double complete_10_cm = share_within(to_map_m, 0.1);
    const double complete_20_cm = share_within(to_map_m, 0.2);
    to_stdout("{:>10}{:>9.2f}{:>9.2f}{:>9.2f}{:>9.2f}{:>9.2f}{:>8.3f}{:>8.3f}  {}{}\n",
              points_m.size(), 100.0 * accuracy_10_cm, 100.0 * accuracy_20_cm,
              100.0 * (1.0 - share_within(to_surface_m, kFar_m)), 100.0 * complete_10_cm,
              100.0 * complete_20_cm, harmonic_mean(accuracy_10_cm, complete_10_cm),
              harmonic_mean(accuracy_20_cm, complete_20_cm), path, is_aligned ? " (aligned)" : "");
  }
}

constexpr const char* kMapDefinitions =
    R"(Definitions
  true surface  standing things of the simulated city, and what its windows show
                (curtains, rooms, seats), but no moving cars and walkers
  visible       the points where the beams of the drive's sensor, all its rows,
                meet the true surface, without noise, drop-outs and traffic,
                within range and bright enough; one sample per voxel of 0.1 m
  accuracy      share of the map's points within 0.1 and 0.2 m of the surface
  far           share of the map's points farther than 0.3 m from it
  complete      share of the visible samples within 0.1 and 0.2 m of the map
  F1            harmonic mean of accuracy and completeness at the same distance
                (Knapitsch et al., Tanks and Temples, 2017)
A map with a trajectory.tum in its folder is aligned first: by the mean rotation and
translation from the poses of that file to the true ones.)";

void declare(CLI::App& app, EvaluateMapOptions& options) {
  add_command(app, "evaluate-map", "Compare dense maps of a simulated drive with its true city",
              kMapDefinitions)
      .option("MAP", &options.maps,
              "Folders with a dense_map.pcd (of hqslam run --dense-map), .pcd or .ply files",
              {.required = true, .given = Given::kFileOrFolder})
      .option("--drive", &options.drive, "Folder of the drive, written by hqslam-lab simulate",
              {.required = true, .given = Given::kFolder});
}

int run(const EvaluateMapOptions& options) {
  sim::DriveSpec spec = sim::read_drive_json(file_of(options.drive, "drive.json"));
  const SensorModel sensor = load_sensor(file_of(options.drive, "sensor.json"));
  const TrajectoryFile truth = read_trajectory_file(file_of(options.drive, "truth.tum"));
  spec.scans = std::ssize(truth.poses);  // the simulation may have been stopped
  evaluate_dense_maps(options.maps, spec, sensor, truth);
  return kOk;
}

}  // namespace

void add_evaluate_map(CLI::App& app, Chosen& chosen) {
  add_subcommand<EvaluateMapOptions>(app, chosen);
}

}  // namespace hqslam::tools

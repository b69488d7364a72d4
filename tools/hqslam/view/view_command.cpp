#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "files/result_files.h"
#include "hqslam/core/error.h"
#include "hqslam/core/left_out.h"
#include "hqslam/core/point_fields.h"
#include "hqslam/core/projection.h"
#include "hqslam/slam/saved_map.h"
#include "pages/open_page.h"
#include "pages/page.h"
#include "pages/turning_view.h"
#include "product.h"
#include "recording/recording_choice.h"
#include "recording/reference.h"
#include "terminal/command_options.h"
#include "terminal/terminal.h"

namespace hqslam::tools {
namespace {

struct ViewOptions {
  std::vector<std::string> files;
  std::string sensor;     ///< of recordings; empty: their own
  std::int64_t scan = 0;  ///< of recordings
  std::string out;
  bool open = false;
};

ViewCloud cloud_of(Scan points) {
  return {"", std::move(points.points_m), std::move(points.confidence),
          std::move(points.intensity)};
}

ViewCloud saved_map_in(const std::string& path) {
  const slam::SavedMap map = slam::read_saved_map(path);
  ViewCloud cloud;
  const auto add = [&](const std::vector<Eigen::Vector3f>& points_m,
                       const std::vector<float>& intensity) {
    cloud.points_m.insert(cloud.points_m.end(), points_m.begin(), points_m.end());
    cloud.intensity.insert(cloud.intensity.end(), intensity.begin(), intensity.end());
    cloud.intensity.resize(cloud.points_m.size(), std::numeric_limits<float>::quiet_NaN());
  };
  add(map.edges_m, map.edges_intensity);
  add(map.posts_m, map.posts_intensity);
  add(map.planes_m, map.planes_intensity);
  const bool is_any_known =
      !map.edges_intensity.empty() || !map.posts_intensity.empty() || !map.planes_intensity.empty();
  if (!is_any_known) cloud.intensity.clear();
  return cloud;
}

ViewCloud scan_of(const std::string& path, const ViewOptions& options) {
  pipeline::UpsampledRecording input = upsampled_recording({path, options.sensor}, {});
  LeftOut left_out;
  for (std::int64_t used = 0;; ++used) {
    const std::optional<RecordedScan> scan = next_usable(input.recording, left_out);
    const std::int64_t i = used + left_out.scans;  // those left out count
    if (scan && i == options.scan)
      return cloud_of(returns_of(input.upsampler.measured(scan->cloud)));
    if (scan && i < options.scan) continue;
    throw Error("{}: expected a scan {}, found {} scans{}; --scan counts them from 0", path,
                options.scan, used, left_out.scans > 0 ? " that can be used" : "");
  }
}

ViewCloud cloud_in(const std::string& path, const ViewOptions& options) {
  const std::string ending = std::filesystem::path(path).extension().string();
  const bool has_points =
      std::ranges::count(kBinaryPoints, ending) > 0 || std::ranges::count(kTextPoints, ending) > 0;
  ViewCloud cloud = has_points         ? cloud_of(read_point_file(path).scan)
                    : ending == ".npz" ? saved_map_in(path)
                                       : scan_of(path, options);
  if (cloud.points_m.empty()) {
    throw Error("{}: expected points to look at, found none; give another file", path);
  }
  return cloud;
}

ViewGrid grid_in(const std::string& path) {
  if (path.ends_with(".pgm")) {
    throw Error("{}: expected the .yaml file of an occupancy grid, which names its image", path);
  }
  ViewGrid grid{slam::read_occupancy_map(path), {}};
  grid.summary =
      fmt::format("{} x {} cells of {} m", grid.map.columns, grid.map.rows, grid.map.resolution_m);
  return grid;
}

/// A .tum or .kitti file, or a .txt file of poses; nothing for another, such as a .txt of points.
std::optional<TrajectoryFile> trajectory_in(const std::string& path) {
  if (path.ends_with(".tum") || path.ends_with(".kitti")) return read_trajectory_file(path);
  if (!path.ends_with(".txt")) return std::nullopt;
  try {
    return read_trajectory_file(path);
  } catch (const Error&) {
    return std::nullopt;
  }
}

/// The poses of a file, moved rigidly so that its positions are nearest to those of `first` at the
/// same times (of KITTI, which has none, the same number of poses; Umeyama 1991, no scale); as they
/// are where there are no three such pairs. note: which of the two.
Trajectory beside(const TrajectoryFile& first, const TrajectoryFile& file, std::string& note) {
  const bool has_pairs =
      (first.has_stamps && file.has_stamps) || first.poses.size() == file.poses.size();
  if (has_pairs) {
    const auto compared = compare_with_reference(with_stamps_of(file, first.poses), first);
    if (compared) {
      note = fmt::format("{}: aligned to {}, APE RMSE {:.3f} m over {} poses", file.path,
                         first.path, compared->error.translation_statistics.rmse,
                         compared->error.translation_m.size());
      return compared->error.aligned_estimate;
    }
  }
  note = fmt::format("{}: not aligned to {}: fewer than 3 of their poses have the same stamps",
                     file.path, first.path);
  return file.poses;
}

ViewPath path_of(const Trajectory& trajectory) {
  constexpr std::size_t kMostPlaces = 20'000;
  ViewPath path;
  std::vector<Eigen::Vector3f>& piece_m = path.pieces_m.emplace_back();
  for (std::size_t i = 0; i < trajectory.size(); i += 1 + trajectory.size() / kMostPlaces) {
    const Eigen::Vector3f place_m = trajectory[i].T_map_sensor.translation().cast<float>();
    if (place_m.allFinite()) piece_m.push_back(place_m);
  }
  return path;
}

/// All files in one view. notes: what was done to bring them together.
TurningView view_of(const ViewOptions& options, std::vector<std::string>& notes) {
  TurningView view;
  std::optional<TrajectoryFile> first;
  for (const std::string& path : options.files) {
    if (path.ends_with(".yaml") || path.ends_with(".pgm")) {
      if (view.grid) throw Error("{}: expected one occupancy grid, found a second", path);
      view.grid = grid_in(path);
    } else if (std::optional<TrajectoryFile> file = trajectory_in(path)) {
      view.paths.push_back(
          path_of(first ? beside(*first, *file, notes.emplace_back()) : file->poses));
      view.paths.back().name = short_name(path);
      if (!first) first = std::move(file);
    } else {
      view.clouds.push_back(cloud_in(path, options));
      view.clouds.back().name = short_name(path);
    }
  }
  return view;
}

void declare(CLI::App& app, ViewOptions& options) {
  Command command = add_command(
      app, "view",
      "Make a page on which maps, trajectories and scans can be turned, for any browser",
      "The page needs no other file and no network. Large maps are thinned evenly to the number\n"
      "of points that a page may have. Of several maps and scans one is shown at a time, of\n"
      "trajectories all, each aligned to the first (SE(3), by stamps) where three poses are of\n"
      "the same times. Maps, the grid and the first trajectory should be of one frame, as those\n"
      "of one run are.");
  command
      .option("FILE", &options.files,
              "Maps and scans: .pcd, .ply, .bin, .txt or .csv points, a saved_map.npz, or a "
              "recording (as for hqslam run), of which a scan is shown; trajectories: .tum, .kitti "
              "or .txt; the .yaml file of an occupancy grid",
              {.required = true, .given = Given::kFileOrFolder})
      .option("--sensor", &options.sensor,
              "Sensor of the recordings (name or .json file); default: their own")
      .option("--scan", &options.scan, "Index of the scan of each recording, from 0",
              {.shows_default = true, .given = Given::kNotNegative})
      .option("--out", &options.out, "Page to write", {.required = true});
  declare_open(command, options.open);
}

int run(const ViewOptions& options) {
  guard_output_file(options.out, options.files, page_marker("hqslam view"));
  std::vector<std::string> notes;
  const TurningView view = view_of(options, notes);
  std::size_t points = 0;
  for (const ViewCloud& cloud : view.clouds) points += cloud.points_m.size();
  std::string title = short_name(options.files.front());
  if (options.files.size() > 1) title += fmt::format(" and {} more", options.files.size() - 1);
  write_text_file(
      page_html("view", {{"title", title}, {"notes", notes}, {"view", turning_view_json(view)}}),
      options.out);
  for (const std::string& note : notes) to_stdout("{}\n", note);
  to_stdout("{} points, {} {}\nresults: {}\n", points, view.paths.size(),
            view.paths.size() == 1 ? "trajectory" : "trajectories", options.out);
  if (options.open) open_page(options.out);
  return kOk;
}

}  // namespace

void add_view(CLI::App& app, Chosen& chosen) { add_subcommand<ViewOptions>(app, chosen); }

}  // namespace hqslam::tools

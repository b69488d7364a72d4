#include "run/map_choice.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "hqslam/core/angles.h"
#include "hqslam/core/error.h"

namespace hqslam::tools {
namespace {

/// x, y and yaw are the user's, the rest is that of the nearest place of the map: streets have
/// slopes.
Pose start_on_path(const std::vector<slam::SavedPlace>& places, const std::vector<double>& start) {
  if (!std::ranges::all_of(start, [](double v) { return std::isfinite(v); })) {
    throw Error("--start {}: expected three numbers; give X,Y,YAW", fmt::join(start, ","));
  }
  const Eigen::Vector2d start_m(start[0], start[1]);
  const auto distance_m = [&](const slam::SavedPlace& place) {
    return (place.T_map_sensor.translation().head<2>() - start_m).norm();
  };
  const auto nearest = std::ranges::min_element(places, {}, distance_m);
  const Eigen::Vector3d rpy_rad = roll_pitch_yaw_rad(nearest->T_map_sensor);
  return pose_from_xyz_rpy({start[0], start[1], nearest->T_map_sensor.translation().z()},
                           rpy_rad.x(), rpy_rad.y(), radians(start[2]));
}

}  // namespace

void declare_maps(Command& command, MapChoice& choice, const std::vector<const char*>& needs) {
  command
      .option("--save-map", &choice.save_map,
              "Also write saved_map.npz, a map for locating later drives",
              {.excludes = {"--no-loop-closing"}})
      .option("--map", &choice.map_file,
              "Locate the drive in this saved_map.npz of an earlier drive instead of making a map; "
              "the file stays as it is",
              {.given = Given::kFile, .excludes = {"--save-map"}})
      .option("--start", &choice.start,
              "X,Y,YAW: the first pose in the map of --map, in metres and degrees, within 10 m and "
              "25 degrees; default: the whole map is searched",
              {.delimiter = ',', .values = 3, .needs = {"--map"}})
      .option("--dense-map", &choice.dense_map,
              "Also make a dense map of the points of all scans, measured and upsampled; reads the "
              "recording twice more",
              {.needs = needs});
  declare_dense_map(command, choice.map, {"--dense-map"});
  declare_occupancy_grid(command, choice.occupancy_grid, choice.grid, needs);
}

pipeline::PipelineOptions pipeline_options(const SlamSettings& slam, const MapChoice& choice) {
  options_of(choice.grid);  // refused before the drive, not after it
  pipeline::PipelineOptions pipeline;
  pipeline.slam = slam_kind(slam);
  pipeline.slam_options = slam_options(slam);
  if (pipeline.slam == pipeline::SlamKind::kLegoLoam && choice.save_map) {
    throw Error(
        "--save-map: expected SLAM that recognizes places, found --slam lego-loam; leave "
        "--save-map out");
  }
  if (choice.map_file.empty()) return pipeline;
  pipeline.slam_options.loop_closing.enabled = false;
  pipeline.map = slam::read_saved_map(choice.map_file);
  if (!choice.start.empty() && !pipeline.map->places.empty()) {
    pipeline.T_map_level_start = start_on_path(pipeline.map->places, choice.start);
  }
  return pipeline;
}

void add_maps(const InputChoice& recording, const UpsamplingChoice& upsampling,
              const MapChoice& choice, const InterruptGuard& interrupt, RunOutput& output,
              SlamRun& run) {
  const auto add = [&](bool wanted, const auto& make) {
    if (!wanted || interrupt.stop_requested()) return;
    try {
      make();
    } catch (const Error& error) {
      run.failed_maps.emplace_back(error.what());
    }
  };
  // The grid, which is small, comes first: the report with the dense map has both.
  add(choice.occupancy_grid, [&] {
    const OccupancyGridRun grid =
        build_occupancy_grid(recording, upsampling, poses_of(run), choice.grid, interrupt);
    if (interrupt.stop_requested()) return;
    run.occupancy_grid_summary = grid.summary;
    output.write_occupancy_grid(run, grid.map);
  });
  add(choice.dense_map, [&] {
    const DenseMapRun dense_map =
        build_dense_map(recording, upsampling, poses_of(run), choice.map, interrupt);
    if (interrupt.stop_requested()) return;
    run.dense_map_summary = dense_map_summary(dense_map);
    output.write_dense_map(run, dense_map);
  });
}

int exit_status_of_maps(const MapChoice& choice, const SlamRun& run) {
  for (const std::string& failed : run.failed_maps) to_stderr("hqslam: {}\n", failed);
  if (!run.failed_maps.empty()) return kWrongInput;
  if (!run.located_in.empty() && !is_located(run)) {
    to_stderr("hqslam: no scan was located in {}; {}\n", run.located_in,
              choice.start.empty()
                  ? "give the map of this place, or --start"
                  : "leave --start out to search all of the map, or give the map of this place");
    return kWrongInput;
  }
  const bool lacks_dense_map = choice.dense_map && run.dense_map_summary.empty();
  if (!lacks_dense_map && !(choice.occupancy_grid && run.occupancy_grid_summary.empty())) {
    return kOk;
  }
  if (run.end == ReadingEnd::kComplete) {
    to_stderr("hqslam: interrupted; the results are valid, but there is no {}\n",
              lacks_dense_map ? "dense map" : "occupancy grid");
  }
  return kInterrupted;
}

}  // namespace hqslam::tools

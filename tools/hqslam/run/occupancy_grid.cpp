#include "run/occupancy_grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "hqslam/core/error.h"
#include "run/map_input.h"
#include "timing/timing.h"

namespace hqslam::tools {

namespace fs = std::filesystem;

void declare_occupancy_grid(Command& command, bool& wanted, OccupancyGridChoice& choice,
                            const std::vector<const char*>& needs) {
  const std::vector<const char*> grid = {"--occupancy-grid"};
  command
      .option("--occupancy-grid", &wanted,
              "Also make an occupancy grid, map.pgm and map.yaml, for Nav2; reads the recording "
              "three times more",
              {.needs = needs})
      .option("--grid-cell", &choice.resolution_m, "Cell size of the occupancy grid, metres",
              {.shows_default = true, .within = std::pair(0.02, 1.0), .needs = grid})
      .option("--grid-band", &choice.band_m,
              "LOW,HIGH: heights above the ground, metres, between which something is an obstacle",
              {.shows_default = true, .delimiter = ',', .values = 2, .needs = grid});
}

slam::OccupancyGridOptions options_of(const OccupancyGridChoice& choice) {
  slam::OccupancyGridOptions options;
  options.resolution_m = choice.resolution_m;
  options.lowest_obstacle_m = choice.band_m.at(0);
  options.highest_obstacle_m = choice.band_m.at(1);
  if (options.lowest_obstacle_m >= options.highest_obstacle_m) {
    throw Error("--grid-band {},{}: expected LOW,HIGH, the lower height first",
                options.lowest_obstacle_m, options.highest_obstacle_m);
  }
  slam::validate(options);
  return options;
}

OccupancyGridRun build_occupancy_grid(const InputChoice& recording,
                                      const UpsamplingChoice& upsampling, const ScanPoses& poses,
                                      const OccupancyGridChoice& choice,
                                      const InterruptGuard& interrupt) {
  const SteadyClock::time_point start = SteadyClock::now();
  MapInput input(recording, upsampling, choice.resolution_m);
  slam::OccupancyGrid grid(options_of(choice));
  const SensorModel sensor = input.measuring();
  input.read_measured(
      poses, "occupancy grid, ground", interrupt,
      [&](const auto& scan, const auto& path) { grid.add_ground(scan, sensor, path); });
  input.read_upsampled(
      poses, "occupancy grid, obstacles", interrupt,
      [&](const auto& scan, const auto& path) { grid.insert(scan, input.measured_rows(), path); });
  const MapReading reading = input.read_measured(
      poses, "occupancy grid, seen through", interrupt,
      [&](const auto& scan, const auto& path) { grid.see_through(scan, path); });
  if (interrupt.stop_requested()) return {};
  if (reading.scans == 0) {
    throw Error(
        "occupancy grid: expected scans that were located, found none of {}; give another "
        "recording or, with --map, a map of its place",
        reading.without_pose);
  }
  OccupancyGridRun run{grid.map(), ""};
  const auto share_of = [&](slam::Occupancy occupancy) {
    return 100.0 * static_cast<double>(std::ranges::count(run.map.cells, occupancy)) /
           static_cast<double>(run.map.cells.size());
  };
  run.summary = fmt::format(
      "occupancy grid: {} x {} cells of {} m, {:.1f} % free, {:.1f} % occupied, of {} scans, "
      "{:.1f} s{}",
      run.map.columns, run.map.rows, run.map.resolution_m, share_of(slam::Occupancy::kFree),
      share_of(slam::Occupancy::kOccupied), reading.scans, seconds_since(start),
      grid.is_full() ? "; full: give a larger --grid-cell for the rest" : "");
  return run;
}

void guard_occupancy_grid(const fs::path& folder, const Paths& inputs) {
  for (const char* const& name : kOccupancyGridFiles) {
    guard_results(folder, {&name, 1}, has_marker(folder / name, "# written by hqslam"),
                  "was not written by hqslam", inputs);
  }
}

void write_occupancy_grid(const slam::OccupancyMap& map, const fs::path& folder) {
  PartFiles parts;
  slam::write_occupancy_image(map, parts.add(folder / kOccupancyGridFiles[0]));
  slam::write_occupancy_yaml(map, kOccupancyGridFiles[0],
                             parts.add(folder / kOccupancyGridFiles[1]));
  parts.rename();
}

}  // namespace hqslam::tools

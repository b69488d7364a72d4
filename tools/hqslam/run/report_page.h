#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "hqslam/slam/occupancy_grid.h"
#include "pages/turning_view.h"
#include "run/dense_map.h"
#include "run/slam_run.h"

namespace hqslam::tools {

/// The dense map of a run if there is one, the features of its map, its path, loops and scans.
/// Other submaps, if there are any, are not in it: their relative pose is unknown. It has views of
/// the run's scans.
TurningView view_of(const SlamRun& run, const DenseMapRun* dense_map = nullptr);

/// What tools/web/report.html shows: headline numbers, the view of the map and the scans, the
/// trajectory from above, errors and poses over time, time per stage, statuses, and the occupancy
/// grid if there is one.
nlohmann::ordered_json report_json(const SlamRun& run, const DenseMapRun* dense_map = nullptr,
                                   const slam::OccupancyMap* grid = nullptr);
std::string report_html(const SlamRun& run, const DenseMapRun* dense_map = nullptr,
                        const slam::OccupancyMap* grid = nullptr);

}  // namespace hqslam::tools

#pragma once

#include "report/turning_view.h"
#include "run/dense_map.h"
#include "run/slam_run.h"

namespace hqslam::tools {

/// What a run has to be looked at: its dense map if there is one, the features of its map, its
/// path, loops and scans, whose points are where the sensor was when it measured each. Other parts
/// of the map, if there are any, are not in it.
TurningView view_of(const SlamRun& run, const DenseMapRun* dense_map = nullptr);

}  // namespace hqslam::tools

#pragma once

#include <tuple>

#include "calibrate/calibrate_command.h"
#include "evaluate/evaluate_command.h"
#include "info/info_command.h"
#include "inspect/inspect_command.h"
#include "live/live_command.h"
#include "program/program.h"
#include "replay/replay_command.h"
#include "run/map_command.h"
#include "run/run_command.h"
#include "run/slam_options_command.h"
#include "upsample/upsample_command.h"
#include "view/view_command.h"
#include "weights/weights_command.h"

namespace hqslam::tools {

/// The subcommands of the program hqslam.
using ProductCommands = std::tuple<RunOptions, LiveOptions, InfoOptions, MapOptions, ViewOptions,
                                   EvaluateOptions, InspectOptions, CalibrateOptions, ReplayOptions,
                                   UpsampleOptions, WeightsOptions, SlamOptionsCommand>;

inline ProgramText product_text() {
  return {"hqslam", "LiDAR SLAM on plain CPUs: from a recorded drive to a trajectory and a map."};
}

}  // namespace hqslam::tools

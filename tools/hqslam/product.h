#pragma once

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

/// Its subcommands are in the order of the help.
inline Program product() {
  return {"hqslam",
          "LiDAR SLAM on plain CPUs: from a recorded drive to a trajectory and a map.",
          {add_subcommand<RunOptions>, add_subcommand<LiveOptions>, add_subcommand<InfoOptions>,
           add_subcommand<MapOptions>, add_subcommand<ViewOptions>, add_subcommand<EvaluateOptions>,
           add_subcommand<InspectOptions>, add_subcommand<CalibrateOptions>,
           add_subcommand<ReplayOptions>, add_subcommand<UpsampleOptions>,
           add_subcommand<WeightsOptions>, add_subcommand<SlamOptionsCommand>}};
}

}  // namespace hqslam::tools

#pragma once

#include <tuple>

#include "commands.h"
#include "program/program.h"

namespace hqslam::tools {

/// The subcommands of the program hqslam.
using ProductCommands =
    std::tuple<RunOptions, LiveOptions, InfoOptions, MapOptions, ViewOptions, EvaluateOptions,
               InspectOptions, CalibrateOptions, UpsampleOptions, WeightsOptions,
               SlamOptionsCommand>;

inline ProgramText product_text() {
  return {"hqslam", "LiDAR SLAM on plain CPUs: from a recorded drive to a trajectory and a map."};
}

}  // namespace hqslam::tools

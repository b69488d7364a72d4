#pragma once

#include "live/live_command.h"
#include "program/program.h"
#include "run/run_command.h"

namespace hqslam::tools {

// The subcommands, each in the file of its name, with its options.
void add_info(CLI::App& app, Chosen& chosen);
void add_map(CLI::App& app, Chosen& chosen);
void add_view(CLI::App& app, Chosen& chosen);
void add_evaluate(CLI::App& app, Chosen& chosen);
void add_inspect(CLI::App& app, Chosen& chosen);
void add_calibrate(CLI::App& app, Chosen& chosen);
void add_replay(CLI::App& app, Chosen& chosen);
void add_upsample(CLI::App& app, Chosen& chosen);
void add_weights(CLI::App& app, Chosen& chosen);
void add_slam_options(CLI::App& app, Chosen& chosen);

/// Its subcommands are in the order of the help.
inline Program product() {
  return {"hqslam",
          "LiDAR SLAM on plain CPUs: from a recorded drive to a trajectory and a map.",
          {add_subcommand<RunOptions>, add_subcommand<LiveOptions>, add_info, add_map, add_view,
           add_evaluate, add_inspect, add_calibrate, add_replay, add_upsample, add_weights,
           add_slam_options}};
}

}  // namespace hqslam::tools

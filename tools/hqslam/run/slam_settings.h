#pragma once

#include <string>
#include <utility>
#include <vector>

#include "hqslam/pipeline/pipeline.h"
#include "hqslam/slam/options.h"
#include "terminal/command_options.h"

namespace hqslam::tools {

/// What a user asks of SLAM.
struct SlamSettings {
  std::string kind = "hqslam";   ///< or "lego-loam"
  std::vector<std::string> set;  ///< "mapping.max_iterations=12"
  bool loop_closing = true;
};
/// --slam.
void declare_slam_kind(Command& command, SlamSettings& settings);
/// --set and --no-loop-closing.
void declare_slam_settings(Command& command, SlamSettings& settings);

/// Throws Error for options that LeGO-LOAM does not have.
pipeline::SlamKind slam_kind(const SlamSettings& settings);
/// The options of SLAM. Throws Error: no such option, no number, out of bounds.
slam::SlamOptions slam_options(const SlamSettings& settings);

/// The options that are not their defaults: name and value.
std::vector<std::pair<std::string, double>> changed_options(const slam::SlamOptions& options);

}  // namespace hqslam::tools

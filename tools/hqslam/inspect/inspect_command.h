#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "recording/recording_choice.h"
#include "run/slam_settings.h"

namespace hqslam::tools {

struct InspectOptions : InputChoice {  ///< sensor empty: as for hqslam upsample
  std::string weights;
  bool slam = false;  ///< what SLAM makes of it, not the network; weights: upsampled by it first
  int rows = 0;       ///< as UpsamplingChoice::rows
  SlamSettings slam_settings;
  std::string poses;  ///< for networks with a memory; empty: they have none of earlier scans
  std::int64_t scan = 0;
  std::vector<std::string> tensors;  ///< by name
  bool list = false;                 ///< print their names, write nothing
  bool reference = false;            ///< compare all of them with the reference
  std::vector<double> pixel;         ///< row and column of one to print, layer by layer; or empty
  std::vector<std::string> what_if;  ///< changes of the loop (what_if.h)
  std::string npz;                   ///< empty: tensors are not written
  std::string out;
  bool open = false;
};

void declare(CLI::App& app, InspectOptions& options);
/// Returns an ExitStatus. Throws Error.
int run(const InspectOptions& options);

}  // namespace hqslam::tools

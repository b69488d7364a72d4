#pragma once

#include <CLI/App.hpp>
#include <optional>
#include <string>

#include "recording_choice.h"

namespace hqslam::tools {

struct UpsampleOptions : InputChoice {  ///< sensor empty: as UpsamplingRequest says
  std::string weights;                  ///< this one
  std::string method;                   ///< or this one
  std::string out;
  std::optional<float> least_confidence;
  int threads = 0;  ///< 0: what OpenMP chooses
  bool bin = false;
  bool pcd = false;
  bool png = false;
};

void declare_upsample(CLI::App& app, UpsampleOptions& options);
/// Returns an ExitStatus. Throws Error.
int upsample_command(const UpsampleOptions& options);

}  // namespace hqslam::tools

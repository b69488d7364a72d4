#pragma once

#include <string>

#include "terminal/command_options.h"

namespace hqslam::tools {

struct WeightsOptions {
  std::string show;  ///< the weights file of `weights show`; empty: `weights pack`
  std::string arrays;
  std::string description;
  std::string out;
};

void declare(CLI::App& app, WeightsOptions& options);
/// Returns an ExitStatus. Throws Error.
int run(const WeightsOptions& options);

}  // namespace hqslam::tools

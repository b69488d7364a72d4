#pragma once

#include <string>

#include "terminal/command_options.h"

namespace hqslam::tools {

struct InfoOptions {
  std::string input;
  std::string sensor;  ///< empty: the recording's own
  std::string stream;  ///< empty: the only one with scans
  std::string write_sensor;
};

void declare(CLI::App& app, InfoOptions& options);
/// Returns an ExitStatus. Throws Error.
int run(const InfoOptions& options);

}  // namespace hqslam::tools

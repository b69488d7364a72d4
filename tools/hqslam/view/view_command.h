#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "terminal/command_options.h"

namespace hqslam::tools {

struct ViewOptions {
  std::vector<std::string> files;
  std::string sensor;     ///< of recordings; empty: their own
  std::int64_t scan = 0;  ///< of recordings
  std::string out;
  bool open = false;
};

void declare(CLI::App& app, ViewOptions& options);
/// Returns an ExitStatus. Throws Error.
int run(const ViewOptions& options);

}  // namespace hqslam::tools

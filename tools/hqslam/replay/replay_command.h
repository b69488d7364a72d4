#pragma once

#include <cstdint>
#include <string>

#include "terminal/command_options.h"

namespace hqslam::tools {

struct ReplayOptions {
  std::string capture;
  std::string to = "127.0.0.1";
  std::uint16_t port = 0;  ///< 0: those of the capture
  double speed = 1.0;
};

void declare(CLI::App& app, ReplayOptions& options);
/// Returns an ExitStatus. Throws Error.
int run(const ReplayOptions& options);

}  // namespace hqslam::tools

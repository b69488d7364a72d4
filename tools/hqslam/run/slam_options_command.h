#pragma once

#include "terminal/command_options.h"

namespace hqslam::tools {

struct SlamOptionsCommand {
  bool json = false;
};

void declare(CLI::App& app, SlamOptionsCommand& options);
/// Returns an ExitStatus. Throws Error.
int run(const SlamOptionsCommand& options);

}  // namespace hqslam::tools

#pragma once

#include <string>

#include "terminal/command_options.h"

namespace hqslam::tools {

struct EvaluateOptions {
  std::string estimate;
  std::string reference;
  std::string alignment = "se3";
  std::string sensor;  ///< of two .npy stacks: adds the errors in 3-D
};

void declare(CLI::App& app, EvaluateOptions& options);
/// Returns an ExitStatus. Throws Error.
int run(const EvaluateOptions& options);

}  // namespace hqslam::tools

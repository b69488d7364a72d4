#pragma once

#include <string>

namespace CLI {
class App;
}

namespace hqslam::tools {

struct EvaluateOptions {
  std::string estimate;
  std::string reference;
  std::string alignment = "se3";
  std::string sensor;  ///< of two .npy stacks: adds the errors in 3-D
};

void declare_evaluate(CLI::App& app, EvaluateOptions& options);
/// Prints the errors. Returns an ExitStatus. Throws Error.
int evaluate_command(const EvaluateOptions& options);

}  // namespace hqslam::tools

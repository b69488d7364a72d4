#pragma once

#include <string>

namespace CLI {
class App;
}

namespace hqslam::tools {

struct PackOptions {
  std::string arrays;
  std::string description;
  std::string out;
};

struct WeightsOptions {
  std::string show;  ///< the weights file of `weights show`
  PackOptions pack;
};

void declare_weights(CLI::App& app, WeightsOptions& options);

/// Returns an ExitStatus. Throws Error.
int weights_command(const WeightsOptions& options);

}  // namespace hqslam::tools

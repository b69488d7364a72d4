#pragma once

#include <string>

namespace CLI {
class App;
}

namespace hqslam::tools {

struct InfoOptions {
  std::string input;
  std::string sensor;  ///< empty: what the recording says
  std::string stream;  ///< empty: the only one with scans
};

void declare_info(CLI::App& app, InfoOptions& options);

/// Returns an ExitStatus. Throws Error.
int info_command(const InfoOptions& options);

}  // namespace hqslam::tools

#pragma once

#include <CLI/App.hpp>
#include <cstdint>
#include <string>

namespace hqslam::tools {

struct InspectOptions {
  std::string input;
  std::string weights;
  std::string sensor;  ///< empty: as for hqslam upsample
  std::int64_t scan = 0;
  std::string out;
};

void declare_inspect(CLI::App& app, InspectOptions& options);
/// Returns an ExitStatus. Throws Error.
int inspect_command(const InspectOptions& options);

}  // namespace hqslam::tools

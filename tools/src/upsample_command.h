#pragma once

#include <CLI/App.hpp>
#include <optional>
#include <string>

namespace hqslam::tools {

struct UpsampleOptions {
  std::string input;
  std::string weights;  ///< this one
  std::string method;   ///< or this one
  std::string sensor;   ///< empty: as UpsamplingRequest says
  std::string stream;   ///< of a capture or a bag; empty: the only one with scans
  std::string out;
  std::optional<float> least_confidence;
  std::string row_order = "highest-first";
  bool motion_corrected = false;
  int threads = 0;  ///< 0: what OpenMP chooses
  bool bin = false;
  bool pcd = false;
  bool png = false;
};

void declare_upsample(CLI::App& app, UpsampleOptions& options);
/// Returns an ExitStatus. Throws Error.
int upsample_command(const UpsampleOptions& options);

}  // namespace hqslam::tools

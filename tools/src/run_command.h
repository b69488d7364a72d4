#pragma once

#include <CLI/App.hpp>
#include <optional>
#include <string>

#include "interrupt.h"
#include "reference.h"
#include "slam_run.h"

namespace hqslam::tools {

struct RunOptions {
  std::string input;
  std::string sensor;  ///< empty: sensor.json in a folder written by `hqslam simulate`
  int rows = 0;        ///< 0: all
  std::string stream;  ///< of a capture or a bag; empty: the only one with scans
  std::string kept_return = "strongest";
  std::string out;
  std::string reference;  ///< empty: truth.tum in a folder written by `hqslam simulate`, or none
  std::string row_order = "highest-first";
  bool motion_corrected = false;
  std::string capture;   ///< "rolling": points without a time have that of their azimuth
  std::string stamps;    ///< a file, or "names"; empty: what the recording says
  std::string upsample;  ///< weights file or interpolation; empty: the recording as it is
  std::optional<float> least_confidence;  ///< nothing: as the weights say
  int threads = 0;                        ///< 0: what OpenMP chooses
  bool loop_closing = false;
};

void declare_run(CLI::App& app, RunOptions& options);

/// A run and how it compares with its reference.
struct RunResult {
  SlamRun run;
  std::optional<ReferenceComparison> comparison;
};
/// Runs and writes the results, printing nothing but progress. Without a single scan nothing is
/// written. Throws Error, also if the first scan cannot be read.
RunResult run_and_write(const RunOptions& options, const InterruptGuard& interrupt);

/// Returns an ExitStatus. Throws Error.
int run_command(const RunOptions& options);

}  // namespace hqslam::tools

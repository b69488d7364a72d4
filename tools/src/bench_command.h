#pragma once

#include <CLI/App.hpp>
#include <cstdint>
#include <string>

namespace hqslam::tools {

struct BenchOptions {
  std::string input;   ///< empty: a simulated drive
  std::string sensor;  ///< of the input
  std::string drive = "block";
  std::int64_t scans = 200;
  bool json = false;
};

void declare_bench(CLI::App& app, BenchOptions& options);
/// Measures and prints. Returns an ExitStatus. Throws Error.
int bench_command(const BenchOptions& options);

}  // namespace hqslam::tools

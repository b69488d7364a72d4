#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "recording/recording_choice.h"

namespace CLI {
class App;
}

namespace hqslam::tools {

struct BenchOptions {
  InputChoice recording;  ///< its input empty: a simulated drive
  std::string drive = "block";
  std::int64_t scans = 200;
  std::vector<std::string> weights;  ///< empty: those that come with the program
  bool json = false;
  bool cpu = false;  ///< print only which instruction set is in use
};

void declare(CLI::App& app, BenchOptions& options);
/// Returns an ExitStatus. Throws Error.
int run(const BenchOptions& options);

}  // namespace hqslam::tools

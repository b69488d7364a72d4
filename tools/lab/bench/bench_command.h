#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace hqslam::tools {

struct BenchOptions {
  std::int64_t scans = 200;          ///< of a simulated drive
  std::vector<std::string> weights;  ///< empty: those that come with the program
  bool json = false;
  bool cpu = false;  ///< print only which instruction set is in use
};

void declare(CLI::App& app, BenchOptions& options);
/// Returns an ExitStatus. Throws Error.
int run(const BenchOptions& options);

}  // namespace hqslam::tools

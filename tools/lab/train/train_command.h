#pragma once

#include <string>

namespace CLI {
class App;
}

namespace hqslam::tools {

struct TrainOptions {
  std::string config;
  std::string out;
  std::string drives;  ///< empty: the folder "drives" in `out`
  int threads = 0;     ///< 0: what OpenMP chooses
};

void declare(CLI::App& app, TrainOptions& options);
/// Returns an ExitStatus. Throws Error.
int run(const TrainOptions& options);

}  // namespace hqslam::tools

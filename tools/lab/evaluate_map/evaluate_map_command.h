#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace hqslam::tools {

struct EvaluateMapOptions {
  std::vector<std::string> maps;
  std::string drive;
};

void declare(CLI::App& app, EvaluateMapOptions& options);
/// Returns an ExitStatus. Throws Error.
int run(const EvaluateMapOptions& options);

}  // namespace hqslam::tools

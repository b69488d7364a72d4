#pragma once

#include <string>

namespace CLI {
class App;
}

namespace hqslam::tools {

struct DemoOptions {
  std::string out = "hqslam-demo";
  bool open = false;
};

void declare(CLI::App& app, DemoOptions& options);
/// Returns an ExitStatus. Throws Error.
int run(const DemoOptions& options);

}  // namespace hqslam::tools

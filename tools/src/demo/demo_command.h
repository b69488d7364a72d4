#pragma once

#include <string>

namespace CLI {
class App;
}

namespace hqslam::tools {

struct DemoOptions {
  std::string out = "hqslam-demo";
};

void declare_demo(CLI::App& app, DemoOptions& options);
/// Returns an ExitStatus. Throws Error.
int demo_command(const DemoOptions& options);

}  // namespace hqslam::tools

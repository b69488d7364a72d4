#pragma once

namespace CLI {
class App;
}

namespace hqslam::tools {

struct SlamOptionsCommand {
  bool json = false;
};
/// hqslam slam-options: every option with its default, its bounds and what it means.
void declare_slam_options(CLI::App& app, SlamOptionsCommand& options);
/// Returns an ExitStatus.
int slam_options_command(const SlamOptionsCommand& options);

}  // namespace hqslam::tools

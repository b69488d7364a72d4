#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "recording/recording_choice.h"
#include "run/slam_settings.h"

namespace CLI {
class App;
}

namespace hqslam::tools {

struct LiveCommandOptions : LiftingChoice {
  std::string sensor;
  std::uint16_t port = 0;  ///< 0: the sensor's usual one
  std::string kept_return = "strongest";
  std::string out;
  std::string record;  ///< a .pcap file; empty: none
  int threads = 0;     ///< 0: what OpenMP chooses
  SlamSettings slam;
  std::optional<std::uint16_t> view;  ///< port of the page; nothing: no page
  std::string view_address = "127.0.0.1";
};

void declare_live(CLI::App& app, LiveCommandOptions& options);

/// Returns an ExitStatus: kOk where Ctrl-C ended it, which is how it is to end. Throws Error.
int live_command(const LiveCommandOptions& options);

}  // namespace hqslam::tools

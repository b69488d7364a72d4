#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "recording/recording_choice.h"
#include "run/map_choice.h"
#include "run/slam_settings.h"

namespace hqslam::tools {

struct LiveOptions : UpsamplingChoice, MapChoice {
  std::string sensor;
  std::uint16_t port = 0;  ///< 0: the sensor's usual one
  std::string kept_return = "strongest";
  std::string out;
  std::string record;  ///< a .pcap file; empty: none
  int threads = 0;     ///< 0: what OpenMP chooses
  SlamSettings slam;
  std::optional<std::uint16_t> view;  ///< port of the page; nothing: no page
  std::string view_address = "127.0.0.1";
  bool open = false;  ///< that page
};

void declare(CLI::App& app, LiveOptions& options);
/// Returns an ExitStatus. Throws Error.
int run(const LiveOptions& options);

}  // namespace hqslam::tools

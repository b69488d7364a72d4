#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace hqslam::tools {

/// What bench --json prints, as tables for a terminal:
///   {input, sensor, cores, slam: [time_slam], networks: [time_network]}
std::string bench_text(const nlohmann::ordered_json& measured);

}  // namespace hqslam::tools

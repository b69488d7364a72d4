#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "laboratory/bench/bench_network.h"

namespace hqslam::tools {

void to_json(nlohmann::ordered_json& json, const Distribution& distribution);
void to_json(nlohmann::ordered_json& json, const MultiplyAddPeak& peak);
void to_json(nlohmann::ordered_json& json, const NetworkTiming& network);

/// Tables for people on stdout; nothing if no network was measured.
void print_networks(const std::vector<MultiplyAddPeak>& peaks,
                    const std::vector<NetworkTiming>& networks);

/// Which instruction sets the network's kernels can use here, and which one they do.
void print_instruction_sets(bool json);

}  // namespace hqslam::tools

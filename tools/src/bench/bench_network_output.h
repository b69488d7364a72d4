#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "bench/bench_network.h"

namespace hqslam::tools {

nlohmann::ordered_json distribution_json(const Distribution& distribution);
nlohmann::ordered_json peaks_json(const std::vector<MultiplyAddPeak>& peaks);
nlohmann::ordered_json networks_json(const std::vector<NetworkTiming>& networks);

/// Tables for people on stdout; nothing if no network was measured.
void print_networks(const std::vector<MultiplyAddPeak>& peaks,
                    const std::vector<NetworkTiming>& networks);

/// Which instruction sets the network's kernels can use here, and which one they do.
void print_instruction_sets(bool json);

}  // namespace hqslam::tools

#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "inspect/layers_report.h"

namespace hqslam::tools {

/// What tools/web/layers.html shows: every image in groups (input, layers, result, tensors that
/// were asked for), the figures of layers, and the differences from the reference.
nlohmann::ordered_json layers_json(const LayersReport& report);
std::string layers_html(const LayersReport& report);

}  // namespace hqslam::tools

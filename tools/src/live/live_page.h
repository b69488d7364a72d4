#pragma once

#include <string>

namespace hqslam::tools {

/// The page that asks LiveView for its state twice a second and draws path and map from above:
/// nothing else is loaded.
std::string live_page(const std::string& title);

}  // namespace hqslam::tools

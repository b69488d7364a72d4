#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "hqslam/slam/scan_trace.h"
#include "hqslam/slam/slam.h"

namespace hqslam::tools {

/// What SLAM makes of one scan, stage by stage.
struct SlamScanReport {
  std::string recording;
  std::int64_t scan = 0;
  slam::ScanReport report;
  slam::ScanTrace trace;
};

/// What tools/web/slam_scan.html shows: the class of every pixel, the features with their matches
/// in the map, the expected, the odometry's and the found pose, and how well each direction of
/// motion is known.
nlohmann::ordered_json slam_scan_json(const SlamScanReport& report);
std::string slam_scan_html(const SlamScanReport& report);

}  // namespace hqslam::tools

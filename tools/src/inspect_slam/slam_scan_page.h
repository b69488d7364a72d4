#pragma once

#include <cstdint>
#include <string>

#include "hqslam/slam/scan_trace.h"
#include "hqslam/slam/slam.h"

namespace hqslam::tools {

/// Tells a page of this kind from other files.
inline constexpr const char* kSlamScanPageMarker =
    R"(<meta name="generator" content="hqslam inspect --slam">)";

/// One scan on its way through SLAM.
struct SlamScanReport {
  std::string recording;
  std::int64_t scan = 0;
  slam::ScanReport report;
  slam::ScanTrace trace;
};

/// A page that needs no other file: the range image by class and by feature, the scan from above
/// by class and by residual, where the sensor was expected and found, matches by kind of feature,
/// and what is known about each direction of motion.
std::string slam_scan_html(const SlamScanReport& report);

}  // namespace hqslam::tools

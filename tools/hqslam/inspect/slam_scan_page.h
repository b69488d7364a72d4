#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "hqslam/evaluation/png.h"
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

inline constexpr Rgb kGroundColour = {150, 116, 80};
inline constexpr Rgb kClusterColour = {80, 140, 220};
inline constexpr Rgb kClutterColour = {240, 170, 60};

inline constexpr std::array<slam::FeatureKind, 4> kFeatureKinds = {
    slam::FeatureKind::kEdge, slam::FeatureKind::kPost, slam::FeatureKind::kSurface,
    slam::FeatureKind::kGround};
Rgb colour_of(slam::FeatureKind kind);
/// What colours mean, as markup.
std::string legend_html(const std::vector<std::pair<Rgb, std::string>>& entries);

/// The pixels of a scan by their class, darker the farther they are.
RgbImage class_image(const slam::ScanTrace& trace);
/// The scan in grey, with its features.
RgbImage feature_image(const slam::ScanTrace& trace);
/// Points by class, 40 m about the sensor, which looks upwards.
RgbImage class_from_above(const slam::ScanTrace& trace);

/// As a figure with SVG: features from above; those that were matched by their residual, with the
/// step to their line or plane 20 times as long.
std::string residuals_picture(const slam::ScanTrace& trace);
/// Where the sensor was expected, where the odometry saw it, and where it was found, from above.
std::string poses_picture(const slam::ScanTrace& trace);

}  // namespace hqslam::tools

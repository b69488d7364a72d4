#pragma once

#include <array>
#include <string>
#include <string_view>

#include "hqslam/evaluation/png.h"
#include "hqslam/slam/scan_trace.h"

namespace hqslam::tools {

inline constexpr Rgb kGroundColour = {150, 116, 80};
inline constexpr Rgb kClusterColour = {80, 140, 220};
inline constexpr Rgb kClutterColour = {240, 170, 60};

inline constexpr std::array<slam::FeatureKind, 4> kFeatureKinds = {
    slam::FeatureKind::kEdge, slam::FeatureKind::kPost, slam::FeatureKind::kSurface,
    slam::FeatureKind::kGround};
Rgb colour_of(slam::FeatureKind kind);
/// "#rrggbb"
std::string css(const Rgb& colour);

/// A picture as a figure of a page.
std::string image_html(const RgbImage& image, std::string_view css_class, std::string_view caption);

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

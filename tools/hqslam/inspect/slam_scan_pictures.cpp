#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "inspect/slam_scan_page.h"
#include "report/cloud_picture.h"

namespace hqslam::tools {
namespace {

using slam::FeatureKind;
using slam::PixelClass;
using slam::ScanTrace;
using slam::TracedFeature;

constexpr double kReach_m = 40.0;
constexpr int kSide = 640;  // pixels of a picture from above
constexpr double kStepFactor = 20.0;
constexpr double kWorstResidual_m = 0.1;

Rgb colour_of(PixelClass pixel_class) {
  if (pixel_class == PixelClass::kGround) return kGroundColour;
  if (pixel_class == PixelClass::kCluster) return kClusterColour;
  return pixel_class == PixelClass::kOutlier ? kClutterColour : Rgb{0, 0, 0};
}

Rgb dimmed(const Rgb& colour, double share) {
  Rgb result;
  for (std::size_t i = 0; i < 3; ++i) {
    result[i] = static_cast<std::uint8_t>(std::lround(share * colour[i]));
  }
  return result;
}

/// 1 near the sensor, 0.3 at 80 m and beyond.
double brightness(float range_m) {
  return std::clamp(1.15 - 0.2 * std::log1p(static_cast<double>(range_m)), 0.3, 1.0);
}

/// "#rrggbb"
std::string css(const Rgb& colour) {
  return fmt::format("#{:02x}{:02x}{:02x}", colour[0], colour[1], colour[2]);
}

/// Green at no residual, red at 0.1 m and more.
Rgb residual_colour(double residual_m) {
  return color_between(std::array<Rgb, 3>{{{40, 170, 90}, {230, 190, 50}, {220, 50, 40}}},
                       std::min(std::sqrt(residual_m / kWorstResidual_m), 1.0));
}

}  // namespace

Rgb colour_of(FeatureKind kind) {
  if (kind == FeatureKind::kEdge) return {235, 60, 50};
  if (kind == FeatureKind::kPost) return {230, 90, 220};
  return kind == FeatureKind::kGround ? Rgb{220, 190, 120} : Rgb{70, 200, 220};
}

std::string legend_html(const std::vector<std::pair<Rgb, std::string>>& entries) {
  std::string html = "<ul class=\"legend\">";
  for (const auto& [colour, name] : entries) {
    html += fmt::format("<li><i style=\"background:{}\"></i>{}</li>", css(colour), name);
  }
  return html + "</ul>\n";
}

RgbImage class_image(const ScanTrace& trace) {
  RgbImage image{trace.cloud.rows, trace.cloud.columns, {}};
  for (std::size_t pixel = 0; pixel < trace.pixel_class.size(); ++pixel) {
    image.pixels.push_back(
        dimmed(colour_of(trace.pixel_class[pixel]), brightness(trace.cloud.range_m[pixel])));
  }
  return image;
}

RgbImage feature_image(const ScanTrace& trace) {
  RgbImage image{trace.cloud.rows, trace.cloud.columns, {}};
  for (const float range_m : trace.cloud.range_m) {
    image.pixels.push_back(range_m > 0.0F ? dimmed({120, 120, 120}, brightness(range_m))
                                          : Rgb{0, 0, 0});
  }
  // Surfaces and ground are many: edges and posts are drawn over them.
  for (auto kind = kFeatureKinds.rbegin(); kind != kFeatureKinds.rend(); ++kind) {
    for (const TracedFeature& feature : trace.features) {
      if (feature.kind != *kind) continue;
      image.pixels[trace.cloud.index(feature.row, feature.column)] = colour_of(feature.kind);
    }
  }
  return image;
}

RgbImage class_from_above(const ScanTrace& trace) {
  RgbImage image{kSide, kSide, std::vector<Rgb>(std::size_t{kSide} * kSide, Rgb{12, 14, 18})};
  const auto draw = [&](const Eigen::Vector3f& point_m, const Rgb& colour) {
    const auto row = static_cast<int>(std::lround((1.0 - point_m.x() / kReach_m) * kSide / 2.0));
    const auto column = static_cast<int>(std::lround((1.0 - point_m.y() / kReach_m) * kSide / 2.0));
    if (row < 0 || row >= kSide || column < 0 || column >= kSide) return;
    image.pixels[static_cast<std::size_t>(row) * kSide + static_cast<std::size_t>(column)] = colour;
  };
  for (const PixelClass drawn : {PixelClass::kGround, PixelClass::kOutlier, PixelClass::kCluster}) {
    for (std::size_t pixel = 0; pixel < trace.pixel_class.size(); ++pixel) {
      const Eigen::Vector3f& point_m = trace.cloud.points_m[pixel];
      if (trace.pixel_class[pixel] != drawn || point_m.head<2>().norm() > 2.0F * kReach_m) continue;
      draw(point_m, colour_of(drawn));
    }
  }
  for (int i = -4; i <= 4; ++i) {
    for (int j = -4; j <= 4; ++j) {
      draw(Eigen::Vector3f(static_cast<float>(i), static_cast<float>(j), 0.0F) / 10.0F,
           {255, 255, 255});
    }
  }
  return image;
}

std::string residuals_picture(const ScanTrace& trace) {
  std::string svg =
      fmt::format("<figure><svg viewBox=\"{0} {0} {1} {1}\" role=\"img\" aria-label=\"residuals\">",
                  -kReach_m, 2.0 * kReach_m);
  const Pose T_level_map = trace.T_map_level.inverse();
  for (const TracedFeature& feature : trace.features) {
    const Eigen::Vector3d point_m = feature.point_m.cast<double>();
    if (point_m.head<2>().cwiseAbs().maxCoeff() > kReach_m) continue;
    const std::string at = fmt::format("cx=\"{:.2f}\" cy=\"{:.2f}\"", -point_m.y(), -point_m.x());
    if (!feature.is_matched) {
      svg += fmt::format(
          "<circle {} r=\".2\" fill=\"none\" stroke=\"#888\" stroke-width=\".08\"><title>{}, not "
          "matched</title></circle>",
          at, name(feature.kind));
      continue;
    }
    const std::string colour = css(residual_colour(feature.residual_m));
    const Eigen::Vector3d step_m = T_level_map * feature.on_map_m.cast<double>() - point_m;
    const Eigen::Vector3d end_m = point_m + kStepFactor * step_m;
    svg += fmt::format(
        "<line x1=\"{:.2f}\" y1=\"{:.2f}\" x2=\"{:.2f}\" y2=\"{:.2f}\" stroke=\"{}\" "
        "stroke-width=\".1\"/><circle {} r=\".22\" fill=\"{}\"><title>{}: {:.0f} mm, weight {:.0f} "
        "per m</title></circle>",
        -point_m.y(), -point_m.x(), -end_m.y(), -end_m.x(), colour, at, colour, name(feature.kind),
        1e3 * feature.residual_m, feature.weight_per_m);
  }
  return svg +
         "<path d=\"M-.7 .9L0-1.2L.7 .9Z\" fill=\"currentColor\"/></svg><figcaption>Features by "
         "their residual: green 0, red 10 cm and more, grey not matched. Lines lead to the map, 20 "
         "times as long.</figcaption></figure>\n";
}

std::string poses_picture(const ScanTrace& trace) {
  struct Drawn {
    const char* name;
    const Pose& pose;
    Rgb colour;
  };
  const std::array<Drawn, 3> poses = {{{"expected", trace.T_map_expected, {140, 140, 150}},
                                       {"odometry", trace.T_map_odometry, {226, 163, 60}},
                                       {"found", trace.T_map_level, {44, 92, 212}}}};
  const Pose T_found_map = trace.T_map_level.inverse();
  double reach_m = 0.01;
  for (const Drawn& drawn : poses) {
    reach_m = std::max(reach_m, 1.3 * (T_found_map * drawn.pose).translation().head<2>().norm());
  }
  std::string svg = "<figure><svg viewBox=\"-170 -62 340 124\" role=\"img\" aria-label=\"poses\">";
  for (const Drawn& drawn : poses) {
    const Pose T_found_pose = T_found_map * drawn.pose;
    const Eigen::Vector2d at = 50.0 / reach_m * T_found_pose.translation().head<2>();
    const Eigen::Vector2d ahead = 22.0 * T_found_pose.linear().col(0).head<2>();
    svg += fmt::format(
        "<g stroke=\"{0}\" fill=\"{0}\"><line x1=\"{1:.2f}\" y1=\"{2:.2f}\" x2=\"{3:.2f}\" "
        "y2=\"{4:.2f}\" stroke-width=\"1.2\"/><circle cx=\"{1:.2f}\" cy=\"{2:.2f}\" r=\"2.5\"/>"
        "</g>",
        css(drawn.colour), -at.y(), -at.x(), -at.y() - ahead.y(), -at.x() - ahead.x());
  }
  std::vector<std::pair<Rgb, std::string>> legend;
  for (const Drawn& drawn : poses) legend.emplace_back(drawn.colour, drawn.name);
  return svg + "</svg>" + legend_html(legend) +
         fmt::format(
             "<figcaption>From above, the sensor looks upwards; the picture is {:.1f} cm "
             "high.</figcaption></figure>\n",
             100.0 * reach_m * 124.0 / 50.0);
}

}  // namespace hqslam::tools

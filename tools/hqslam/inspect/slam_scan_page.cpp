#include "inspect/slam_scan_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "hqslam/core/angles.h"
#include "hqslam/slam/status.h"
#include "pages/page.h"

namespace hqslam::tools {
namespace {

using Json = PageJson;
using slam::FeatureKind;
using slam::TracedFeature;

/// The picture from above reaches so far; points beyond it stand at its edge.
constexpr float kReach_m = 160.0F;

Json numbers_json(const SlamScanReport& page) {
  const slam::ScanReport& report = page.report;
  const slam::ScanTrace& trace = page.trace;
  const Eigen::Matrix<double, 6, 1> variance = report.covariance.diagonal();
  const auto number = [](const char* label, std::string value, const char* unit, std::string note) {
    return Json{{"label", label}, {"value", value}, {"unit", unit}, {"note", note}};
  };
  return {
      number("mapping", std::string(name(report.mapping_status)), "",
             fmt::format("state: {} → {}", trace.state_before, trace.state)),
      number("odometry", std::string(name(report.odometry_status)), "",
             fmt::format("{} edges, {} flat points", trace.sharp_edges, trace.flat_points)),
      number("returns", fmt::format("{}", report.returns), "",
             fmt::format("{} on the ground", report.ground_points)),
      number("inlier ratio", fmt::format("{:.2f}", trace.inlier_ratio), "",
             fmt::format("{:.2f} in the last registered scan", trace.last_inlier_ratio)),
      number("standard deviation", fmt::format("{:.3f}", std::sqrt(variance.head<3>().sum())), "m",
             fmt::format("and {:.3f}° of the pose",
                         kDegreesPerRadian * std::sqrt(variance.tail<3>().sum()))),
      number("keyframe", report.keyframe ? "yes" : "no", "",
             fmt::format("loop: {}", name(report.loop.status)))};
}

/// Per pixel: range, class (slam::PixelClass) and place in the level frame.
Json pixels_json(const slam::ScanTrace& trace) {
  RangeImage ranges(trace.cloud.rows, trace.cloud.columns);
  ranges.range_m = trace.cloud.range_m;
  std::vector<std::uint8_t> classes;
  for (const slam::PixelClass pixel_class : trace.pixel_class) {
    classes.push_back(static_cast<std::uint8_t>(pixel_class));
  }
  const auto coordinate = [&](int axis) {
    std::vector<float> values_m;
    for (const Eigen::Vector3f& point_m : trace.cloud.points_m) values_m.push_back(point_m[axis]);
    return u16_block(values_m, -kReach_m, kReach_m);
  };
  return {
      {"rows", ranges.rows},          {"columns", ranges.columns}, {"ranges", range_block(ranges)},
      {"classes", u8_block(classes)}, {"x", coordinate(0)},        {"y", coordinate(1)}};
}

/// Of each feature: pixel, place in the level frame, and if it was matched the step to its line or
/// plane of the map, its residual and its weight.
Json features_json(const slam::ScanTrace& trace) {
  const Pose T_level_map = trace.T_map_level.inverse();
  std::vector<std::uint8_t> kind, matched;
  std::vector<float> x, y, z, step_x, step_y, residual_mm, weight_per_m;
  Json row = Json::array(), column = Json::array();
  for (const TracedFeature& feature : trace.features) {
    kind.push_back(static_cast<std::uint8_t>(feature.kind));
    matched.push_back(feature.is_matched ? 1 : 0);
    row.push_back(feature.row);
    column.push_back(feature.column);
    x.push_back(feature.point_m.x());
    y.push_back(feature.point_m.y());
    z.push_back(feature.point_m.z());
    const Eigen::Vector3d step_m =
        feature.is_matched ? Eigen::Vector3d(T_level_map * feature.on_map_m.cast<double>() -
                                             feature.point_m.cast<double>())
                           : Eigen::Vector3d::Zero();
    step_x.push_back(static_cast<float>(step_m.x()));
    step_y.push_back(static_cast<float>(step_m.y()));
    residual_mm.push_back(static_cast<float>(1e3 * feature.residual_m));
    weight_per_m.push_back(static_cast<float>(feature.weight_per_m));
  }
  Json kinds = Json::array();
  for (const FeatureKind each :
       {FeatureKind::kEdge, FeatureKind::kPost, FeatureKind::kGround, FeatureKind::kSurface}) {
    kinds.push_back(name(each));
  }
  return {{"kinds", std::move(kinds)},
          {"kind", u8_block(kind)},
          {"matched", u8_block(matched)},
          {"row", std::move(row)},
          {"column", std::move(column)},
          {"x", f32_block(x)},
          {"y", f32_block(y)},
          {"z", f32_block(z)},
          {"step_x", f32_block(step_x)},
          {"step_y", f32_block(step_y)},
          {"residual_mm", f32_block(residual_mm)},
          {"weight_per_m", f32_block(weight_per_m)}};
}

/// The expected pose, the odometry's and the found one, in the frame of the found one.
Json poses_json(const slam::ScanTrace& trace) {
  Json poses = Json::array();
  for (const auto& [name, pose] : {std::pair{"expected", &trace.T_map_expected},
                                   std::pair{"by the odometry", &trace.T_map_odometry},
                                   std::pair{"found", &trace.T_map_level}}) {
    const Pose T_found_other = trace.T_map_level.inverse() * *pose;
    const Eigen::Vector3d shift_cm = 100.0 * T_found_other.translation();
    const Eigen::Vector3d turn_deg = kDegreesPerRadian * roll_pitch_yaw_rad(T_found_other);
    poses.push_back({{"name", name},
                     {"shift_cm", {shift_cm.x(), shift_cm.y(), shift_cm.z()}},
                     {"turn_deg", {turn_deg.x(), turn_deg.y(), turn_deg.z()}}});
  }
  return poses;
}

/// A direction in words: its components of a tenth and more.
std::string direction_text(const Eigen::Matrix<double, 6, 1>& direction) {
  constexpr std::array<const char*, 6> kAxes = {"x", "y", "z", "about x", "about y", "about z"};
  std::array<int, 6> order = {0, 1, 2, 3, 4, 5};
  std::ranges::sort(order,
                    [&](int a, int b) { return std::abs(direction[a]) > std::abs(direction[b]); });
  std::string text;
  for (const int axis : order) {
    if (std::abs(direction[axis]) < 0.1) break;
    text += fmt::format("{}{:+.2f} {}", text.empty() ? "" : ", ", direction[axis],
                        kAxes[static_cast<std::size_t>(axis)]);
  }
  return text;
}

/// The least known direction first; none where nothing was matched with a map.
Json directions_json(const slam::ScanTrace& trace) {
  Json directions = Json::array();
  if (trace.direction_share.sum() <= 0.0) return directions;
  for (int i = 0; i < 6; ++i) {
    directions.push_back({{"text", direction_text(trace.direction.col(i))},
                          {"share", trace.direction_share[i]},
                          {"degenerate", i < trace.degenerate_directions}});
  }
  return directions;
}

}  // namespace

Json slam_scan_json(const SlamScanReport& report) {
  return {{"title", fmt::format("Scan {}, stage by stage", report.scan)},
          {"subtitle", fmt::format("{}, at {:.3f} s", report.recording, report.report.stamp_s)},
          {"numbers", numbers_json(report)},
          {"pixels", pixels_json(report.trace)},
          {"features", features_json(report.trace)},
          {"poses", poses_json(report.trace)},
          {"directions", directions_json(report.trace)}};
}

std::string slam_scan_html(const SlamScanReport& report) {
  return page_html("slam_scan", slam_scan_json(report));
}

}  // namespace hqslam::tools

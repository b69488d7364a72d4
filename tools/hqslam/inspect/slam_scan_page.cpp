#include "inspect/slam_scan_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "hqslam/core/angles.h"
#include "hqslam/core/median.h"
#include "hqslam/slam/status.h"
#include "report/page.h"

namespace hqslam::tools {
namespace {

using slam::FeatureKind;
using slam::TracedFeature;

constexpr const char* kStyle = R"css(
figure img { image-rendering: pixelated; background: #000; }
figure svg { width: 100%; display: block; background: var(--panel); border-radius: 8px; }
.bar { height: .6rem; background: var(--estimate); border-radius: 2px; min-width: 1px; }
.weak .bar { background: #c9564a; }
.numbers { grid-template-columns: repeat(auto-fit, minmax(15rem, 1fr)); }
.two { display: grid; grid-template-columns: repeat(auto-fit, minmax(20rem, 1fr)); gap: 1rem; }
)css";

std::vector<PageNumber> numbers_of(const SlamScanReport& page) {
  const slam::ScanReport& report = page.report;
  const slam::ScanTrace& trace = page.trace;
  const Eigen::Matrix<double, 6, 1> variance = report.covariance.diagonal();
  return {{"mapping", std::string(name(report.mapping_status)), "",
           fmt::format("{} → {}", trace.state_before, trace.state)},
          {"odometry", std::string(name(report.odometry_status)), "",
           fmt::format("{} edges, {} flat points", trace.sharp_edges, trace.flat_points)},
          {"returns", fmt::format("{}", report.returns), "",
           fmt::format("{} on the ground, {} clusters", report.ground_points, report.clusters)},
          {"inlier ratio", fmt::format("{:.2f}", trace.inlier_ratio), "",
           fmt::format("{:.2f} in the last registered scan", trace.last_inlier_ratio)},
          {"known within", fmt::format("{:.3f}", std::sqrt(variance.head<3>().sum())), "m",
           fmt::format("and {:.3f}° (one sigma)",
                       kDegreesPerRadian * std::sqrt(variance.tail<3>().sum()))},
          {"keyframe", report.keyframe ? "yes" : "no", "",
           fmt::format("loop: {}", name(report.loop.status))}};
}

void add_poses(Page& page, const slam::ScanTrace& trace) {
  page.heading(2, "Expected and found");
  page.paragraph("Relative to the pose that was found, in the level frame of the sensor.");
  TextTable table{.columns = {"", "x, cm", "y, cm", "z, cm", "roll, °", "pitch, °", "yaw, °"}};
  for (const auto& [name, pose] :
       {std::pair{"expected, with the velocity of the scan before", &trace.T_map_expected},
        std::pair{"by the odometry", &trace.T_map_odometry}}) {
    const Pose T_found_other = trace.T_map_level.inverse() * *pose;
    const Eigen::Vector3d shift_cm = 100.0 * T_found_other.translation();
    const Eigen::Vector3d turn_deg = kDegreesPerRadian * roll_pitch_yaw_rad(T_found_other);
    std::vector<std::string>& cells = table.rows.emplace_back();
    cells.emplace_back(name);
    for (const double value : shift_cm) cells.push_back(figure_text(value, 2));
    for (const double value : turn_deg) cells.push_back(figure_text(value, 3));
  }
  page.table(table);
  page.html(poses_picture(trace));
}

void add_matches(Page& page, const slam::ScanTrace& trace) {
  const auto information = [](const TracedFeature& feature) {
    return feature.is_matched ? feature.weight_per_m * feature.weight_per_m : 0.0;
  };
  const auto middle = [](const std::vector<double>& values) {
    return values.empty() ? 0.0 : median(values);
  };
  const double all = std::accumulate(
      trace.features.begin(), trace.features.end(), 0.0,
      [&](double sum, const TracedFeature& feature) { return sum + information(feature); });
  TextTable table{.columns = {"feature", "in the scan", "matched", "median residual, mm",
                              "median weight, 1/m", "share of the weight"}};
  for (const FeatureKind kind : kFeatureKinds) {
    std::vector<double> residuals_m;
    std::vector<double> weights_per_m;
    double sum = 0.0;
    int features = 0;
    for (const TracedFeature& feature : trace.features) {
      if (feature.kind != kind) continue;
      ++features;
      sum += information(feature);
      if (!feature.is_matched) continue;
      residuals_m.push_back(feature.residual_m);
      weights_per_m.push_back(feature.weight_per_m);
    }
    table.rows.push_back({std::string(name(kind)), fmt::format("{}", features),
                          fmt::format("{}", residuals_m.size()),
                          figure_text(1e3 * middle(residuals_m), 1),
                          figure_text(middle(weights_per_m), 1),
                          fmt::format("{:.0f} %", all > 0.0 ? 100.0 * sum / all : 0.0)});
  }
  page.heading(2, "Matches with the map");
  page.table(table);
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

std::string directions_html(const slam::ScanTrace& trace) {
  std::string html =
      "<h2>Directions of motion</h2>\n<p class=\"quiet\">How much of the matches' weight each "
      "direction moves, the least known first; in axes of the map about the sensor, rotations "
      "times 10 m: a match 20 m away they move twice as far, and it counts four times, so that "
      "they can exceed 100 %. Below 0.3 % a direction is degenerate (red): there the prediction "
      "stands.</p>\n"
      "<table><tr><th>direction</th><th>of the weight</th><th></th></tr>\n";
  if (trace.direction_share.sum() <= 0.0) return "<p>Nothing was matched with a map.</p>\n";
  const double longest = std::max(1.0, trace.direction_share.maxCoeff());
  for (int i = 0; i < 6; ++i) {
    html += fmt::format(
        "<tr{}><td>{}</td><td>{:.2f} %</td><td style=\"width:40%\"><div class=\"bar\" "
        "style=\"width:{:.1f}%\"></div></td></tr>\n",
        i < trace.degenerate_directions ? " class=\"weak\"" : "",
        direction_text(trace.direction.col(i)), 100.0 * trace.direction_share[i],
        100.0 * std::max(trace.direction_share[i], 0.0) / longest);
  }
  return html + "</table>\n";
}

}  // namespace

std::string slam_scan_html(const SlamScanReport& report) {
  const slam::ScanTrace& trace = report.trace;
  Page page(fmt::format("SLAM of scan {}", report.scan));
  page.style(kStyle);
  page.head_html(kSlamScanPageMarker);
  page.heading(1, fmt::format("Scan {}, stage by stage", report.scan));
  page.paragraph(fmt::format("{}, at {:.3f} s", report.recording, report.report.stamp_s));
  page.numbers(numbers_of(report));
  page.heading(2, "Segmentation and features");
  page.html(legend_html(
      {{kGroundColour, "ground"}, {kClusterColour, "cluster"}, {kClutterColour, "clutter"}}));
  page.picture(class_image(trace), "Each pixel by its class; dark is far", true);
  page.html(legend_html({{colour_of(FeatureKind::kEdge), "edge"},
                         {colour_of(FeatureKind::kPost), "post"},
                         {colour_of(FeatureKind::kGround), "ground"},
                         {colour_of(FeatureKind::kSurface), "surface"}}));
  page.picture(feature_image(trace), "The features that are matched with the map", true);
  page.heading(2, "From above");
  page.html("<div class=\"two\">");
  page.picture(class_from_above(trace), "Points by class, 40 m about the sensor; it looks upwards");
  page.html(residuals_picture(trace) + "</div>\n");
  add_poses(page, trace);
  add_matches(page, trace);
  page.html(directions_html(trace));
  return page.text();
}

}  // namespace hqslam::tools

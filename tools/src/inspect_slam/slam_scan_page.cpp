#include "inspect_slam/slam_scan_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "hqslam/core/angles.h"
#include "hqslam/core/median.h"
#include "hqslam/slam/status.h"
#include "report/chart.h"
#include "report/page.h"

namespace hqslam::tools {
namespace {

using slam::FeatureKind;
using slam::TracedFeature;

constexpr const char* kStyle = R"css(
figure { margin: .75rem 0; }
figure img { width: 100%; display: block; image-rendering: pixelated; background: #000; }
figure img.rows { height: 9rem; }
figure svg { width: 100%; display: block; background: var(--panel); border-radius: 8px; }
figcaption { color: var(--quiet); font-size: .85rem; }
table { border-collapse: collapse; width: 100%; font-size: .9rem; }
th, td { text-align: right; padding: .3rem .5rem; border-bottom: 1px solid var(--rule); }
th:first-child, td:first-child { text-align: left; }
.bar { height: .6rem; background: var(--estimate); border-radius: 2px; min-width: 1px; }
.weak .bar { background: #c9564a; }
.two { display: grid; grid-template-columns: repeat(auto-fit, minmax(20rem, 1fr)); gap: 1rem; }
)css";

std::string legend_html(const std::vector<std::pair<Rgb, std::string>>& entries) {
  std::string html = "<ul class=\"legend\">";
  for (const auto& [colour, name] : entries) {
    html += fmt::format("<li><i style=\"background:{}\"></i>{}</li>", css(colour), name);
  }
  return html + "</ul>\n";
}

std::string number_html(std::string_view name, const std::string& value, std::string_view note) {
  return fmt::format("<div><dt>{}</dt><dd>{}</dd><dd class=\"note\">{}</dd></div>", name, value,
                     note);
}

std::string numbers_html(const SlamScanReport& page) {
  const slam::ScanReport& report = page.report;
  const slam::ScanTrace& trace = page.trace;
  const Eigen::Matrix<double, 6, 1> variance = report.covariance.diagonal();
  return "<dl class=\"numbers\">" +
         number_html("mapping", std::string(name(report.mapping_status)),
                     fmt::format("{} &rarr; {}", trace.state_before, trace.state)) +
         number_html(
             "odometry", std::string(name(report.odometry_status)),
             fmt::format("{} edges, {} flat points", trace.sharp_edges, trace.flat_points)) +
         number_html(
             "returns", fmt::format("{}", report.returns),
             fmt::format("{} on the ground, {} clusters", report.ground_points, report.clusters)) +
         number_html("inlier ratio", fmt::format("{:.2f}", trace.inlier_ratio),
                     fmt::format("{:.2f} in the last registered scan", trace.last_inlier_ratio)) +
         number_html("known within",
                     fmt::format("{:.3f} <small>m</small>", std::sqrt(variance.head<3>().sum())),
                     fmt::format("and {:.3f}° (one sigma)",
                                 kDegreesPerRadian * std::sqrt(variance.tail<3>().sum()))) +
         number_html("keyframe", report.keyframe ? "yes" : "no",
                     fmt::format("loop: {}", name(report.loop.status))) +
         "</dl>\n";
}

std::string poses_html(const slam::ScanTrace& trace) {
  std::string html =
      "<h2>Expected and found</h2>\n<p class=\"quiet\">Relative to the pose that was found, in the "
      "level frame of the sensor.</p>\n<table><tr><th></th><th>x, cm</th><th>y, cm</th><th>z, "
      "cm</th><th>roll, °</th><th>pitch, °</th><th>yaw, °</th></tr>\n";
  for (const auto& [name, pose] :
       {std::pair{"expected, with the velocity of the scan before", &trace.T_map_expected},
        std::pair{"by the odometry", &trace.T_map_odometry}}) {
    const Pose T_found_other = trace.T_map_level.inverse() * *pose;
    const Eigen::Vector3d shift_cm = 100.0 * T_found_other.translation();
    const Eigen::Vector3d turn_deg = kDegreesPerRadian * roll_pitch_yaw_rad(T_found_other);
    html += fmt::format(
        "<tr><td>{}</td><td>{:.2f}</td><td>{:.2f}</td><td>{:.2f}</td><td>{:.3f}</td><td>{:.3f}</td>"
        "<td>{:.3f}</td></tr>\n",
        name, shift_cm.x(), shift_cm.y(), shift_cm.z(), turn_deg.x(), turn_deg.y(), turn_deg.z());
  }
  return html + "</table>\n" + poses_picture(trace);
}

std::string matches_html(const slam::ScanTrace& trace) {
  const auto information = [](const TracedFeature& feature) {
    return feature.is_matched ? feature.weight_per_m * feature.weight_per_m : 0.0;
  };
  const auto middle = [](const std::vector<double>& values) {
    return values.empty() ? 0.0 : median(values);
  };
  const double all = std::accumulate(
      trace.features.begin(), trace.features.end(), 0.0,
      [&](double sum, const TracedFeature& feature) { return sum + information(feature); });
  std::string html =
      "<h2>Matches with the map</h2>\n<table><tr><th>feature</th><th>in the scan</th><th>matched"
      "</th><th>median residual, mm</th><th>median weight, 1/m</th><th>share of the weight</th>"
      "</tr>\n";
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
    html += fmt::format(
        "<tr><td>{}</td><td>{}</td><td>{}</td><td>{:.1f}</td><td>{:.1f}</td><td>{:.0f} "
        "%</td></tr>\n",
        name(kind), features, residuals_m.size(), 1e3 * middle(residuals_m), middle(weights_per_m),
        all > 0.0 ? 100.0 * sum / all : 0.0);
  }
  return html + "</table>\n";
}

/// A direction in words: its components of a tenth and more.
std::string direction_text(const Eigen::Matrix<double, 6, 1>& direction) {
  constexpr std::array<const char*, 6> kAxes = {"x", "y", "z", "about x", "about y", "about z"};
  std::array<int, 6> order = {0, 1, 2, 3, 4, 5};
  std::sort(order.begin(), order.end(),
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
      "<h2>Directions of motion</h2>\n<p class=\"quiet\">Which share of the matches' weight has "
      "information about each direction, the least known first; in axes of the map about the "
      "sensor, rotations times 10 m. Below 0.3 % a direction is degenerate (red): there the "
      "prediction stands.</p>\n<table><tr><th>direction</th><th>share</th><th></th></tr>\n";
  if (trace.direction_share.sum() <= 0.0) return "<p>Nothing was matched with a map.</p>\n";
  for (int i = 0; i < 6; ++i) {
    html += fmt::format(
        "<tr{}><td>{}</td><td>{:.2f} %</td><td style=\"width:40%\"><div class=\"bar\" "
        "style=\"width:{:.1f}%\"></div></td></tr>\n",
        i < trace.degenerate_directions ? " class=\"weak\"" : "",
        direction_text(trace.direction.col(i)), 100.0 * trace.direction_share[i],
        100.0 * std::max(trace.direction_share[i], 0.0));
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
  std::string html = numbers_html(report);
  html += "<h2>Segmentation and features</h2>\n";
  html += legend_html(
      {{kGroundColour, "ground"}, {kClusterColour, "cluster"}, {kClutterColour, "clutter"}});
  html += image_html(class_image(trace), "rows", "Each pixel by its class; dark is far");
  html += legend_html({{colour_of(FeatureKind::kEdge), "edge"},
                       {colour_of(FeatureKind::kPost), "post"},
                       {colour_of(FeatureKind::kGround), "ground"},
                       {colour_of(FeatureKind::kSurface), "surface"}});
  html += image_html(feature_image(trace), "rows", "The features that are matched with the map");
  html += "<h2>From above</h2>\n<div class=\"two\">";
  html += image_html(class_from_above(trace), "",
                     "Points by class, 40 m about the sensor; it looks upwards");
  html += residuals_picture(trace);
  html += "</div>\n" + poses_html(trace) + matches_html(trace) + directions_html(trace);
  page.html(html);
  return page.text();
}

}  // namespace hqslam::tools

#include "run/html_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <numeric>

#include "hqslam/evaluation/png.h"
#include "report/chart.h"
#include "report/density_image.h"
#include "report/report_style.h"
#include "run/trajectory_plot.h"
#include "timing/timing_statistics.h"

namespace hqslam::tools {
namespace {

constexpr double kDegreesPerRadian = 57.29577951308232;

/// One headline number: `value` may hold markup, the other two are plain text.
std::string number_html(std::string_view label, const std::string& value, std::string_view note) {
  return fmt::format(
      "<div><dt>{}</dt><dd>{}</dd>{}</div>\n", label, value,
      note.empty() ? "" : fmt::format("<dd class=\"note\">{}</dd>", escape_html(note)));
}

std::string distance_html(double metres) {
  return metres < 10000.0 ? fmt::format("{:.1f} <small>m</small>", metres)
                          : fmt::format("{:.2f} <small>km</small>", 1e-3 * metres);
}

std::string numbers_html(const SlamRun& run, const std::optional<ReferenceComparison>& comparison) {
  std::string html = "<dl class=\"numbers\">\n";
  html += number_html("Scans", fmt::format("{}", run.scans.size()),
                      fmt::format("of {} {}", run.scans_in_recording,
                                  run.command == "live" ? "that came" : "in the recording"));
  html += number_html("Path length", distance_html(known_path_m(run)), "");
  if (comparison) {
    const double rmse_m = comparison->error.translation_statistics.rmse;
    html +=
        number_html("APE RMSE", fmt::format("{:.3f} <small>m</small>", rmse_m), "SE(3)-aligned");
  }
  html += number_html(
      "Scans per second", fmt::format("{:.1f}", scans_per_second(run)),
      fmt::format("reading included, {} thread{}", run.threads, run.threads == 1 ? "" : "s"));
  html += number_html(
      "SLAM per scan",
      fmt::format("{:.1f} <small>ms</small>", distribution_of(slam_times(run).times_ms).median),
      "median");
  if (run.slam.loop_closing.enabled) {
    const std::size_t parts = scans_of_parts(run).size();
    html += number_html("Loops closed", fmt::format("{}", loops_closed(run)),
                        parts > 1 ? fmt::format("{} parts not joined", parts) : "");
  }
  html += number_html("Map points", fmt::format("{}", run.map_points_m.size()), "");
  return html + "</dl>\n";
}

std::string notice_html(const SlamRun& run) {
  if (run.end == RunEnd::kComplete) {
    return "";
  }
  const std::string why = run.end == RunEnd::kInterrupted ? "it was interrupted" : run.end_message;
  return fmt::format(
      "<p class=\"notice\">The run ended after {} of {} scans: {}. What is shown is valid up to "
      "there.</p>\n",
      run.scans.size(), run.scans_in_recording, escape_html(why));
}

/// The recording without most of its path: "kitti_drive_0005/velodyne".
std::string short_name(const SlamRun& run) {
  const std::filesystem::path path(run.input);
  return (path.parent_path().filename() / path.filename()).string();
}

/// Seconds since the first scan.
std::vector<double> times_since_start_s(const Trajectory& trajectory) {
  std::vector<double> times_s;
  for (const StampedPose& pose : trajectory) {
    times_s.push_back(pose.stamp_s - trajectory.front().stamp_s);
  }
  return times_s;
}

std::string error_html(const SlamRun& run, const std::optional<ReferenceComparison>& comparison) {
  if (!comparison) {
    return "<h2>Error over time</h2>\n<p class=\"quiet\">Not compared with a "
           "reference trajectory: <code>--reference FILE</code>, with at least three poses at the "
           "scans' stamps, adds the error.</p>\n";
  }
  const AbsolutePoseError& error = comparison->error;
  const std::vector<double> all_times_s = times_since_start_s(run.trajectory);
  Chart chart;
  chart.x_label = "time, s";
  chart.y_label = "position error, m";
  chart.series = {{"error", "error", error.translation_m}};
  for (const std::size_t pose : error.pairs.estimate) {
    chart.x.push_back(all_times_s[pose]);
  }
  const ErrorStatistics& position = error.translation_statistics;
  const ErrorStatistics& rotation = error.rotation_statistics;
  return fmt::format(
      "<h2>Error over time</h2>\n<p class=\"quiet\">Absolute pose error against {} over {} poses, "
      "after an SE(3) alignment of all positions.</p>\n{}"
      "<div class=\"scroll\"><table><tr><th></th><th>RMSE</th><th>mean</th><th>median</th>"
      "<th>max</th></tr>\n"
      "<tr><td>position, m</td><td>{:.3f}</td><td>{:.3f}</td><td>{:.3f}</td><td>{:.3f}</td></tr>\n"
      "<tr><td>rotation, degrees</td><td>{:.2f}</td><td>{:.2f}</td><td>{:.2f}</td><td>{:.2f}</td>"
      "</tr></table></div>\n",
      escape_html(comparison->reference_path), error.translation_m.size(), chart_html(chart),
      position.rmse, position.mean, position.median, position.max,
      rotation.rmse * kDegreesPerRadian, rotation.mean * kDegreesPerRadian,
      rotation.median * kDegreesPerRadian, rotation.max * kDegreesPerRadian);
}

/// Means of `per_bin` neighbours: a long drive has more scans than a chart has pixels.
std::vector<double> binned(const std::vector<double>& values, std::size_t per_bin) {
  std::vector<double> means;
  for (std::size_t begin = 0; begin < values.size(); begin += per_bin) {
    const std::size_t end = std::min(values.size(), begin + per_bin);
    const double sum = std::accumulate(values.begin() + static_cast<std::ptrdiff_t>(begin),
                                       values.begin() + static_cast<std::ptrdiff_t>(end), 0.0);
    means.push_back(sum / static_cast<double>(end - begin));
  }
  return means;
}

std::string distribution_row(std::string_view name, const std::vector<double>& times_ms,
                             std::string_view css_class) {
  const Distribution d = distribution_of(times_ms);
  return fmt::format(
      "<tr class=\"{}\"><td>{}</td><td>{:.2f}</td><td>{:.2f}</td><td>{:.2f}</td></tr>\n", css_class,
      name, d.median, d.p95, d.max);
}

std::string times_html(const SlamRun& run) {
  if (run.scans.empty()) {
    return "";
  }
  constexpr std::size_t kMostBins = 400;
  const std::vector<ScanTimes> columns = stage_times(run);
  const std::size_t per_bin = (run.scans.size() + kMostBins - 1) / kMostBins;
  Chart chart;
  chart.x_label = per_bin == 1 ? "scan" : fmt::format("scan (means of {} scans)", per_bin);
  chart.y_label = "time per scan, ms";
  chart.stacked = true;
  std::string table =
      "<div class=\"scroll\"><table><tr><th>ms per scan</th><th>median</th><th>95 % below</th>"
      "<th>max</th></tr>\n";
  for (const ScanTimes& column : columns) {
    chart.series.push_back({column.name, column.name, binned(column.times_ms, per_bin)});
    table += distribution_row(column.name, column.times_ms, "");
  }
  table += distribution_row("SLAM, all stages", slam_times(run).times_ms, "total");
  for (std::size_t i = 0; i < chart.series.front().y.size(); ++i) {
    chart.x.push_back(static_cast<double>(i * per_bin));
  }
  return "<h2>Time per stage</h2>\n" + chart_html(chart) + table + "</table></div>\n";
}

std::string status_row(const SlamRun& run, std::string_view stage,
                       slam::Status slam::ScanReport::*status) {
  std::string row = fmt::format("<tr><td>{}</td>", stage);
  for (const auto& [kind, scans] : status_counts(run, status)) {
    row += fmt::format("<td>{}</td>", scans);
  }
  return row + "</tr>\n";
}

std::string statuses_html(const SlamRun& run) {
  std::string names;
  for (const auto& [kind, scans] : status_counts(run, &slam::ScanReport::mapping_status)) {
    names += fmt::format("<th>{}</th>", slam::name(kind));
  }
  return "<h2>How the scans ended</h2>\n<div class=\"scroll\"><table><tr><th>scans</th>" + names +
         "</tr>\n" + status_row(run, "odometry", &slam::ScanReport::odometry_status) +
         status_row(run, "mapping", &slam::ScanReport::mapping_status) + "</table></div>\n";
}

std::string picture_html(const std::string& caption, const RgbImage& image) {
  return fmt::format(
      "<img alt=\"{}\" style=\"width:100%;height:auto\" src=\"data:image/png;base64,{}\">\n",
      caption, base64(encode_png(image)));
}

std::string dense_map_html(const DenseMapPage& page) {
  if (page.run == nullptr || page.pictures == nullptr) {
    return "";
  }
  return fmt::format(
      "<h2>Dense map</h2>\n<p class=\"quiet\">{} points, one per {} m, of {} scans: measured, and "
      "computed where scans agree. Colours tell heights, blue the lowest. The second picture looks "
      "ahead from behind the place where the sensor was after a third of its path.</p>\n{}{}",
      page.run->points.size(), page.run->voxel_m, page.run->scans,
      picture_html("The dense map from above", page.pictures->above),
      picture_html("The dense map in perspective", page.pictures->perspective));
}

}  // namespace

std::string html_report(const SlamRun& run, const std::optional<ReferenceComparison>& comparison,
                        const DenseMapPage& dense_map) {
  const std::string upsampled =
      run.upsampled_by.empty() ? "" : fmt::format(" by {}", run.upsampled_by);
  const std::string title =
      fmt::format("{}, {} rows{}", escape_html(short_name(run)), run.rows, upsampled);
  return page_html(
      fmt::format("hqslam {}: {}", run.command, title), "",
      fmt::format(
          "<h1>{}</h1>\n<p class=\"quiet\">hqslam {}, sensor {}, range images of {} x {}</p>\n",
          title, run.command, escape_html(run.sensor_name), run.rows, run.columns) +
          notice_html(run) + numbers_html(run, comparison) + "<h2>Trajectory from above</h2>\n" +
          trajectory_plot_html(run, comparison) + dense_map_html(dense_map) +
          error_html(run, comparison) + times_html(run) + statuses_html(run));
}

}  // namespace hqslam::tools

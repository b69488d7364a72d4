#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <numeric>

#include "hqslam/core/angles.h"
#include "report/chart.h"
#include "report/page.h"
#include "report/turning_view.h"
#include "run/run_output.h"
#include "timing/timing.h"

namespace hqslam::tools {
namespace {

PageNumber path_length(const SlamRun& run) {
  const double path_m = known_path_m(run);
  if (path_m < 10000.0) return {"Path length", fmt::format("{:.1f}", path_m), "m"};
  return {"Path length", fmt::format("{:.2f}", 1e-3 * path_m), "km"};
}

std::vector<PageNumber> numbers_of(const SlamRun& run) {
  const bool live = run.command == "live";
  std::vector<PageNumber> numbers = {
      {"Scans", fmt::format("{}", run.scans.size()), "",
       run.scans_in_recording ? fmt::format("of {} {}", *run.scans_in_recording,
                                            live ? "that came" : "in the recording")
                              : ""},
      path_length(run)};
  if (run.comparison) {
    const double rmse_m = run.comparison->error.translation_statistics.rmse;
    numbers.push_back({"APE RMSE", fmt::format("{:.3f}", rmse_m), "m", "SE(3)-aligned"});
  }
  numbers.push_back(
      {"Scans per second", fmt::format("{:.1f}", scans_per_second(run)), "",
       fmt::format("reading included, {} thread{}", run.threads, run.threads == 1 ? "" : "s")});
  numbers.push_back({"SLAM per scan",
                     fmt::format("{:.1f}", distribution_of(slam_times(run).times_ms).median), "ms",
                     "median"});
  if (run.slam.loop_closing.enabled) {
    const std::size_t parts = scans_of_parts(run).size();
    numbers.push_back({"Loops closed", fmt::format("{}", loops_closed(run)), "",
                       parts > 1 ? fmt::format("{} parts not joined", parts) : ""});
  }
  numbers.push_back({"Map points", fmt::format("{}", run.map_points_m.size())});
  return numbers;
}

void add_notice(Page& page, const SlamRun& run) {
  if (run.end == ReadingEnd::kComplete) return;
  page.paragraph(
      fmt::format("The run ended after {}: {}. What is shown is valid up to there.",
                  scans_text(std::ssize(run.scans), run.scans_in_recording),
                  run.end == ReadingEnd::kInterrupted ? "it was interrupted" : run.end_message),
      "notice");
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

std::vector<std::string> error_row(const char* name, const ErrorStatistics& error, double scale,
                                   int decimals) {
  std::vector<std::string> cells = {name};
  for (const double value : {error.rmse, error.mean, error.median, error.max}) {
    cells.push_back(figure_text(scale * value, decimals));
  }
  return cells;
}

void add_error(Page& page, const SlamRun& run) {
  page.heading(2, "Error over time");
  if (!run.comparison) {
    page.html(
        "<p class=\"quiet\">Not compared with a reference trajectory: <code>--reference "
        "FILE</code>, with at least three poses at the scans' stamps, adds the error.</p>\n");
    return;
  }
  const AbsolutePoseError& error = run.comparison->error;
  page.paragraph(fmt::format(
      "Absolute pose error against {} over {} poses, after an SE(3) alignment of all positions.",
      run.comparison->reference_path, error.translation_m.size()));
  const std::vector<double> all_times_s = times_since_start_s(run.trajectory);
  Chart chart;
  chart.x_label = "time, s";
  chart.y_label = "position error, m";
  chart.series = {{"error", "error", error.translation_m}};
  for (const std::size_t pose : error.pairs.estimate) chart.x.push_back(all_times_s[pose]);
  page.html(chart_html(chart));
  page.table(
      {.columns = {"", "RMSE", "mean", "median", "max"},
       .rows = {error_row("position, m", error.translation_statistics, 1.0, 3),
                error_row("rotation, degrees", error.rotation_statistics, kDegreesPerRadian, 2)}});
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

void add_times(Page& page, const SlamRun& run) {
  if (run.scans.empty()) return;
  constexpr std::size_t kMostBins = 400;
  std::vector<ScanTimes> stages = stage_times(run);
  const std::size_t per_bin = (run.scans.size() + kMostBins - 1) / kMostBins;
  Chart chart;
  chart.x_label = per_bin == 1 ? "scan" : fmt::format("scan (means of {} scans)", per_bin);
  chart.y_label = "time per scan, ms";
  chart.stacked = true;
  for (const ScanTimes& stage : stages) {
    chart.series.push_back({stage.name, stage.name, binned(stage.times_ms, per_bin)});
  }
  for (std::size_t i = 0; i < chart.series.front().y.size(); ++i) {
    chart.x.push_back(static_cast<double>(i * per_bin));
  }
  stages.push_back({"SLAM, all stages", slam_times(run).times_ms});
  TextTable table{.columns = {"ms per scan", "median", "95 % below", "max"}};
  for (const ScanTimes& stage : stages) {
    const Distribution d = distribution_of(stage.times_ms);
    table.rows.push_back(
        {stage.name, figure_text(d.median, 2), figure_text(d.p95, 2), figure_text(d.max, 2)});
  }
  page.heading(2, "Time per stage");
  page.html(chart_html(chart) + "<div class=\"total\">");
  page.table(table);
  page.html("</div>\n");
}

void add_statuses(Page& page, const SlamRun& run) {
  TextTable table{.columns = {"scans"}, .rows = {{"odometry"}, {"mapping"}}};
  for (const auto& [kind, scans] : status_counts(run, &slam::ScanReport::odometry_status)) {
    table.columns.emplace_back(slam::name(kind));
    table.rows[0].push_back(fmt::format("{}", scans));
  }
  for (const auto& [kind, scans] : status_counts(run, &slam::ScanReport::mapping_status)) {
    table.rows[1].push_back(fmt::format("{}", scans));
  }
  page.heading(2, "How the scans ended");
  page.table(table);
}

void add_dense_map(Page& page, const DenseMapRun& map) {
  page.heading(2, "Dense map");
  page.paragraph(fmt::format(
      "{} points, one per {} m, of {} scans: measured, and computed where scans agree. Colours "
      "tell heights, blue the lowest. The second picture looks ahead from behind the place where "
      "the sensor was after a third of its path.",
      map.points.size(), map.voxel_m, map.scans));
  page.picture(map.pictures.above, "The dense map from above");
  page.picture(map.pictures.perspective, "The dense map in perspective");
}

}  // namespace

std::string html_report(const SlamRun& run, const DenseMapRun* dense_map) {
  const std::string upsampled =
      run.upsampled_by.empty() ? "" : fmt::format(" by {}", run.upsampled_by);
  const std::string title = fmt::format("{}, {} rows{}", short_name(run), run.rows, upsampled);
  Page page(fmt::format("hqslam {}: {}", run.command, title));
  page.heading(1, title);
  page.paragraph(fmt::format("hqslam {}, sensor {}, range images of {} x {}", run.command,
                             run.sensor_name, run.rows, run.columns));
  add_notice(page, run);
  page.numbers(numbers_of(run));
  page.style(kTurningViewStyle);
  page.html(turning_view_html(view_of(run, dense_map)));
  page.heading(2, "Trajectory from above");
  page.html(trajectory_plot_html(run));
  if (dense_map != nullptr) add_dense_map(page, *dense_map);
  add_error(page, run);
  add_times(page, run);
  add_statuses(page, run);
  return page.text();
}

}  // namespace hqslam::tools

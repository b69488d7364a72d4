#include "demo_command.h"

#include <fmt/format.h>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "exit_status.h"
#include "hqslam/core/scan_source.h"
#include "installed_weights.h"
#include "interrupt.h"
#include "progress.h"
#include "recording_sensor.h"
#include "run_command.h"
#include "simulate_command.h"
#include "timing_statistics.h"
#include "upsampling_comparison.h"
#include "upsampling_plan.h"

namespace hqslam::tools {
namespace {

constexpr const char* kWeights = "du-or_os1_16to64.npz";
constexpr int kFewRows = 16;
/// Image errors are means over every so many scans.
constexpr std::int64_t kComparedScans = 10;

/// One way of coming from the drive to a trajectory.
struct Way {
  std::string name;
  std::string folder;    ///< of its results
  int rows = 0;          ///< of the recording that are looked at
  std::string upsample;  ///< as RunOptions::upsample
};

struct DemoRow {
  Way way;
  RunResult result;
  std::optional<UpsamplingScore> score;  ///< of the ways that upsample
};

std::vector<Way> ways(const std::optional<std::string>& weights) {
  std::vector<Way> result = {{"64 beams", "rows-64", 64, ""},
                             {"16 beams", "rows-16", kFewRows, ""},
                             {"16 -> 64, linear", "linear", kFewRows, "linear"}};
  if (weights) {
    result.push_back({"16 -> 64, DU-OR", "du-or", kFewRows, *weights});
  }
  return result;
}

/// The slowest typical part of the whole: the median time that SLAM needs for a scan.
double median_slam_ms(const SlamRun& run) {
  std::vector<double> times_ms;
  for (const ScanRecord& scan : run.scans) {
    times_ms.push_back(1e3 * scan.report.times.total_s);
  }
  return distribution_of(std::move(times_ms)).median;
}

/// Scores the ways that upsample against the drive's own 64 rows.
void score(const std::string& drive, std::vector<DemoRow>& rows, const InterruptGuard& interrupt) {
  std::vector<ComparedMethod> methods;
  for (const DemoRow& row : rows) {
    if (!row.way.upsample.empty()) {
      UpsamplingPlan plan = plan_upsampling({drive, "", row.way.upsample, row.way.rows});
      methods.push_back({row.way.name, std::move(plan.upsampler), std::nullopt});
    }
  }
  UpsamplingComparison comparison(std::move(methods));
  const std::unique_ptr<ScanSource> source =
      open_recording(drive, required_recording_sensor(drive, ""));
  Progress progress("compare with 64 beams", source->size());
  for (std::int64_t i = 0; !interrupt.stop_requested(); ++i) {
    const std::optional<RecordedScan> scan = source->next();
    if (!scan) {
      break;
    }
    if (i % kComparedScans == 0) {
      comparison.add(scan->cloud);
    }
    progress.update(i + 1);
  }
  progress.finish();
  for (const UpsamplingScore& result : comparison.scores()) {
    for (DemoRow& row : rows) {
      if (row.way.name == result.method) {
        row.score = result;
      }
    }
  }
}

std::string ape_text(const RunResult& result) {
  return result.comparison
             ? fmt::format("{:.3f}", result.comparison->error.translation_statistics.rmse)
             : "-";
}

/// The four columns about the images.
std::string score_text(const std::optional<UpsamplingScore>& score) {
  constexpr const char* kColumns = "{:>10}{:>11}{:>10}{:>14}";
  if (!score) {
    return fmt::format(fmt::runtime(kColumns), "-", "-", "-", "-");
  }
  return fmt::format(fmt::runtime(kColumns), fmt::format("{:.3f}", score->mae_all_m),
                     fmt::format("{:.3f}", score->mae_valid_m),
                     fmt::format("{:.2f} %", 100.0 * score->outlier_share),
                     fmt::format("{:.1f}", 1e3 / score->upsampling_ms));
}

void print_table(const std::vector<DemoRow>& rows) {
  fmt::print("{:<18}{:>7}{:>9}{:>10}{:>11}{:>10}{:>14}{:>10}{:>14}\n", "", "scans", "APE, m",
             "MAE all", "MAE valid", "outliers", "upsampling/s", "SLAM, ms", "all, scans/s");
  for (const DemoRow& row : rows) {
    const SlamRun& run = row.result.run;
    fmt::print("{:<18}{:>7}{:>9}{}{:>10.1f}{:>14.1f}\n", row.way.name, run.scans.size(),
               ape_text(row.result), score_text(row.score), median_slam_ms(run),
               scans_per_second(run));
  }
  fmt::print(
      "APE: absolute pose error (RMSE) against the true trajectory, SE(3)-aligned, {:.1f} m of "
      "path\n"
      "MAE: mean |range - true range| in metres, over all pixels and over those where both have a\n"
      "     return; outliers: points farther than 0.5 m from the cloud of 64 beams\n"
      "upsampling/s: scans per second of the upsampling alone; all: reading, upsampling and "
      "SLAM\n\n",
      path_length_m(rows.front().result.run.trajectory));
}

void print_reports(const std::vector<DemoRow>& rows, const std::filesystem::path& out) {
  fmt::print("To look at, in any browser:\n");
  for (const DemoRow& row : rows) {
    fmt::print("  {}\n", (out / row.way.folder / "report.html").string());
  }
}

}  // namespace

void declare_demo(CLI::App& app, DemoOptions& options) {
  CLI::App* command = app.add_subcommand(
      "demo",
      "Simulate a short city drive and run SLAM on it: with 64 beams, with 16, and with 16 that "
      "are upsampled to 64");
  command->add_option("--out", options.out, "Folder for the drive and the results")
      ->capture_default_str();
}

int demo_command(const DemoOptions& options) {
  namespace fs = std::filesystem;
  const InterruptGuard interrupt;
  const auto interrupted = [] {
    fmt::print(stderr, "hqslam: interrupted\n");
    return kInterrupted;
  };
  const fs::path out = fs::absolute(options.out).lexically_normal();
  SimulateOptions simulate;
  simulate.drive = "block";
  simulate.sensor = "os1-64";
  simulate.out = (out / "drive").string();
  if (simulate_drive(simulate, interrupt) == kInterrupted) {
    return interrupted();
  }

  const std::optional<std::string> weights = installed_weights(kWeights);
  std::vector<DemoRow> rows;
  for (const Way& way : ways(weights)) {
    RunOptions run;
    run.input = simulate.out;
    run.rows = way.rows;
    run.upsample = way.upsample;
    run.out = (out / way.folder).string();
    rows.push_back({way, run_and_write(run, interrupt), std::nullopt});
    if (rows.back().result.run.end == RunEnd::kInterrupted) {
      return interrupted();
    }
  }
  score(simulate.out, rows, interrupt);
  if (interrupt.stop_requested()) {
    return interrupted();
  }
  fmt::print("A drive of {} scans through a simulated city, sensor {}.\n\n",
             rows.front().result.run.scans_in_recording, simulate.sensor);
  print_table(rows);
  if (!weights) {
    fmt::print("Without DU-OR: its weights, weights/{}, are not there.\n\n", kWeights);
  }
  print_reports(rows, out);
  return kOk;
}

}  // namespace hqslam::tools

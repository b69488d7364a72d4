#include "demo_command.h"

#include <fmt/format.h>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <array>
#include <cstdio>
#include <filesystem>
#include <vector>

#include "exit_status.h"
#include "interrupt.h"
#include "run_command.h"
#include "simulate_command.h"
#include "timing_statistics.h"

namespace hqslam::tools {
namespace {

constexpr std::array<int, 2> kRowCounts = {64, 16};

struct DemoRow {
  int rows = 0;
  RunResult result;
  std::string report_path;
};

/// The slowest typical part of the whole: the median time that SLAM needs for a scan.
double median_slam_ms(const SlamRun& run) {
  std::vector<double> times_ms;
  for (const ScanRecord& scan : run.scans) {
    times_ms.push_back(1e3 * scan.report.times.total_s);
  }
  return distribution_of(std::move(times_ms)).median;
}

void print_table(const std::vector<DemoRow>& rows) {
  fmt::print("{:>6}{:>8}{:>11}{:>14}{:>11}{:>15}\n", "rows", "scans", "path, m", "APE RMSE, m",
             "scans/s", "SLAM, ms/scan");
  for (const DemoRow& row : rows) {
    const SlamRun& run = row.result.run;
    const std::string ape =
        row.result.comparison
            ? fmt::format("{:.3f}", row.result.comparison->error.translation_statistics.rmse)
            : "-";
    fmt::print("{:>6}{:>8}{:>11.1f}{:>14}{:>11.1f}{:>15.1f}\n", row.rows, run.scans.size(),
               path_length_m(run.trajectory), ape, scans_per_second(run), median_slam_ms(run));
  }
  fmt::print("APE: absolute pose error against the true trajectory, SE(3)-aligned\n\n");
  fmt::print("To look at, in any browser:\n");
  for (const DemoRow& row : rows) {
    fmt::print("  {}\n", row.report_path);
  }
}

}  // namespace

void declare_demo(CLI::App& app, DemoOptions& options) {
  CLI::App* command = app.add_subcommand(
      "demo", "Simulate a short city drive and run SLAM on it, with 64 rows and with 16");
  command->add_option("--out", options.out, "Folder for the drive and the results")
      ->capture_default_str();
}

int demo_command(const DemoOptions& options) {
  namespace fs = std::filesystem;
  const InterruptGuard interrupt;
  const fs::path out = fs::absolute(options.out).lexically_normal();
  SimulateOptions simulate;
  simulate.drive = "block";
  simulate.sensor = "os1-64";
  simulate.out = (out / "drive").string();
  if (simulate_drive(simulate, interrupt) == kInterrupted) {
    fmt::print(stderr, "hqslam: interrupted\n");
    return kInterrupted;
  }

  std::vector<DemoRow> rows;
  for (const int row_count : kRowCounts) {
    RunOptions run;
    run.input = simulate.out;
    run.rows = row_count;
    run.out = (out / fmt::format("rows-{}", row_count)).string();
    rows.push_back({row_count, run_and_write(run, interrupt), run.out + "/report.html"});
    if (rows.back().result.run.end == RunEnd::kInterrupted) {
      fmt::print(stderr, "hqslam: interrupted\n");
      return kInterrupted;
    }
  }
  fmt::print("A drive of {} scans through a simulated city, sensor {}.\n\n",
             rows.front().result.run.scans_in_recording, simulate.sensor);
  print_table(rows);
  return kOk;
}

}  // namespace hqslam::tools

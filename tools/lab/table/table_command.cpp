#include "table/table_command.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "files/result_files.h"
#include "hqslam/core/error.h"
#include "table/table_drive.h"
#include "table/table_report.h"
#include "table/table_work.h"
#include "terminal/command_options.h"
#include "terminal/terminal.h"

namespace hqslam::tools {
namespace {

namespace fs = std::filesystem;

/// The variants of methods, a line each.
std::string variants_help() {
  std::string help =
      "METHOD+VARIANT in --methods, such as du-or+whole-map, is a row with a changed part of\n"
      "SLAM. Variants:\n";
  for (const SlamVariant& variant : slam_variants()) {
    help += fmt::format("  +{:<16} {}\n", variant.name, variant.title);
  }
  return help;
}

/// Throws Error if a table would replace other files.
void guard_tables(const TableOptions& options) {
  const fs::path folder(options.out);
  constexpr std::array<const char*, 3> kWritten = {"table.json", "table.md", "table.html"};
  Paths inputs = options.weights;
  inputs.push_back(options.reference);
  guard_results(folder, kWritten, has_marker((folder / "table.json").string(), kTableJsonMarker),
                "was not written by hqslam-lab table", inputs);
}

/// The figures of all results.
std::vector<DriveFigures> figures_of(const std::vector<DriveWork>& works, const TablePlan& plan) {
  std::vector<DriveFigures> drives;
  for (const DriveWork& work : works) {
    if (!work.is_prepared) continue;
    const std::vector<TableResult> results = results_of(work, plan);
    if (results.empty()) continue;
    drives.push_back(drive_figures(work.drive, work.sensor.name, results, truth_of(work.drive)));
  }
  return drives;
}

std::optional<TableReport> report_of(const std::vector<DriveFigures>& drives,
                                     const TablePlan& plan) {
  if (!plan.over_seeds) return drives.empty() ? std::nullopt : std::optional(drives_report(drives));
  const TableSample sample = sample_of(drives, plan);
  return sample.drives.empty() ? std::nullopt : std::optional(statistics_report(sample));
}

void write_report(const TableReport& report, const fs::path& out) {
  to_stdout("{}", printed(report));
  write_text_file(markdown_of(report), (out / "table.md").string());
  write_text_file(report.json, (out / "table.json").string());
  write_text_file(html_of(report), (out / "table.html").string());
  to_stdout("results: {0}/table.html, table.md and table.json\n", out.string());
}

}  // namespace

void declare(CLI::App& app, TableOptions& options) {
  Command command =
      add_command(app, "table",
                  "Compare SLAM with 16 rows, with 16 upsampled to 64 by every method, and with 64",
                  variants_help() +
                      R"(Writes into --out:
  table.md, table.json, table.html      the tables; the page has maps of the errors too
  results/DRIVE/.../METHOD.json, .tum   finished runs
  drives/NAME                           simulated drives, 320 MB for 1,000 scans
By default the command takes hours and 3 GB: the drives have 12,000 scans, and Simple DU takes
about a second for each. Ctrl-C keeps finished runs; the same command then continues.
With --seeds SLAM runs without loop closing, on as many drives in parallel as there are
threads, with one thread each.
A run is repeated if its result is damaged or was made from other scans, with other weights or
by another build of the program; results of other lengths and builds are kept. Inertial data
and corrections of beams are not used.)");
  command
      .option("--drives", &options.drives,
              fmt::format("Simulated drives ({}) and recordings with {} rows (as for hqslam run), "
                          "separated by commas",
                          fmt::join(sim::drive_preset_names(), ", "), kTableAllRows),
              {.shows_default = true, .delimiter = ','})
      .option("--methods", &options.methods,
              fmt::format("Rows to compute, separated by commas (default: all of {})",
                          fmt::join(table_method_names(), ", ")),
              {.delimiter = ','})
      .option("--weights", &options.weights,
              "Weights files, each an additional row: FILE.npz or FILE.npz+VARIANT",
              {.delimiter = ','})
      .option("--sensor", &options.reading.sensor,
              "Sensor of recordings that have no sensor.json (name or .json file)");
  declare_reading(command, options.reading);
  command
      .option("--reference", &options.reference,
              "True trajectory of the recording in --drives (TUM, or KITTI with one pose per scan)",
              {.given = Given::kFile})
      .option("--scans", &options.scans, "Number of scans of each drive (default: all)",
              {.within = kAnyCount})
      .option("--sensor-errors", &options.sensor_errors,
              "Errors of the sensor of simulated drives, as for hqslam-lab simulate",
              {.shows_default = true, .one_of = sim::sensor_errors_names()})
      .option("--seeds", &options.seeds,
              "Seeds (1..10, or 3,5,8) from each of which every drive of --drives is simulated: "
              "the table "
              "has drift and slips against the truth with 95 % intervals")
      .option("--against", &options.against,
              "With --seeds: the row with which the others are compared drive by drive (default: "
              "linear "
              "or, without it, the first of --methods)",
              {.needs = {"--seeds"}})
      .option("--out", &options.out, "Folder for drives, results and tables", {.required = true});
  declare_threads(command, options.threads);
}

int run(const TableOptions& options) {
  use_threads(options.threads);
  const InterruptGuard interrupt;
  const TablePlan plan = plan_table(options);
  guard_tables(options);
  std::vector<DriveWork> works = work_of(plan, options);
  make_result_folder(options.out);
  const FolderLock lock(options.out);
  const bool complete = run_missing(works, plan, options, interrupt);
  const std::vector<DriveFigures> drives = figures_of(works, plan);
  if (const auto report = report_of(drives, plan)) {
    write_report(*report, options.out);
  } else if (complete) {
    throw Error(
        "expected drives of at least 3 scans to compare with the truth, found none; give more with "
        "--scans");
  }
  for (const DriveFigures& drive : drives) {
    if (drive.left_out.scans > 0)
      to_stderr("hqslam-lab: {}: {}\n", drive.name, drive.left_out.text());
  }
  if (complete) return kOk;
  to_stderr("hqslam-lab: interrupted; finished runs are kept, the same command continues\n");
  return kInterrupted;
}

}  // namespace hqslam::tools

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
#include "ranks/ranks.h"
#include "table/table_drive.h"
#include "table/table_report.h"
#include "table/table_work.h"
#include "terminal/command_options.h"
#include "terminal/terminal.h"

namespace hqslam::tools {
namespace {

namespace fs = std::filesystem;

/// What may stand behind a method's name, a line each.
std::string variants_help() {
  std::string help =
      "Rows that show what a part of SLAM is worth: METHOD+VARIANT in --methods, such as\n"
      "du-or+whole-map, with\n";
  for (const SlamVariant& variant : slam_variants()) {
    help += fmt::format("  +{:<16} {}\n", variant.name, variant.title);
  }
  return help;
}

/// Throws Error if a table would replace what is none.
void guard_tables(const TableOptions& options) {
  const fs::path folder(options.out);
  constexpr std::array<const char*, 3> kWritten = {"table.json", "table.md", "table.html"};
  Paths inputs = options.weights;
  inputs.push_back(options.reference);
  guard_results(folder, kWritten, has_marker((folder / "table.json").string(), kTableJsonMarker),
                "was not written by hqslam-lab table", inputs);
}

/// Of everything that is there.
std::vector<DriveFigures> figures_of(const std::vector<DriveWork>& works, const TablePlan& plan) {
  std::vector<DriveFigures> drives;
  for (const DriveWork& work : works) {
    if (!work.prepared) continue;
    const FoundResults found = results_of(*work.prepared, plan.shown, plan.loop_closing);
    if (found.results.empty()) continue;
    drives.push_back(drive_figures(work.drive, work.prepared->sensor.name, found.methods,
                                   found.results, truth_of(work.drive)));
  }
  return drives;
}

/// The drives that every method has finished.
TableSample sample_of(const std::vector<DriveFigures>& drives, const TablePlan& plan) {
  TableSample sample{plan.methods, plan.against, {}};
  for (const DriveFigures& drive : drives) {
    if (auto finished = drive_sample(drive, plan.methods)) {
      sample.drives.push_back(std::move(*finished));
    }
  }
  return sample;
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
  Command command = add_command(
      app, "table",
      "SLAM with 16 rows, with 16 upsampled to 64 in every way, and with 64, in one table",
      variants_help() +
          R"(Writes into --out:
  table.md, table.json, table.html   the tables; the page also shows where the error is
  results/DRIVE/.../METHOD.json, .tum   each finished run; drives/NAME: simulated drives
Without a choice it takes hours and 3 GB: the drives have 12,000 scans, and Simple DU needs
about a second for one. Ctrl-C keeps what is finished; the same command goes on from there.
With --seeds there are no pictures, SLAM runs without loop closing, and as many drives as
there are threads are under way side by side, with one thread each. A simulated drive of
1,000 scans takes 320 MB.
A result is computed anew if it is damaged or was made from a recording with other scans,
with other weights or by another build of the program; results of other lengths and builds
are kept beside it. Inertial data and corrections of beams are not looked at.
mpirun -n N shares drives and methods among N processes, which must all see the same folders.)");
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
              "Weights files that become rows of their own, FILE.npz or FILE.npz+VARIANT",
              {.delimiter = ','})
      .option("--sensor", &options.reading.sensor,
              "Sensor of recordings that do not say theirs (name or .json file)");
  declare_reading(command, options.reading);
  command
      .option("--reference", &options.reference,
              "True trajectory of the recording in --drives (TUM, or KITTI with one pose per scan)",
              {.given = Given::kFile})
      .option("--scans", &options.scans, "Only so many scans of each drive", {.within = kAnyCount})
      .option("--sensor-errors", &options.sensor_errors,
              "How far the sensor of simulated drives is from its own table (hqslam-lab simulate)",
              {.shows_default = true, .one_of = sim::sensor_errors_names()})
      .option(
          "--seeds", &options.seeds,
          "Every simulated drive of --drives from each of these seeds (1..10, or 3,5,8) instead of "
          "once: drift and slips against the truth, with 95 % intervals")
      .option(
          "--against", &options.against,
          "With --seeds: the row that the others are paired with, drive by drive (default: linear "
          "or, without it, the first of --methods)",
          {.needs = {"--seeds"}})
      .option("--out", &options.out, "Folder for drives, results and tables", {.required = true});
  declare_threads(command, options.threads);
}

int run(const TableOptions& options) {
  use_threads(options.threads);
  const InterruptGuard interrupt;
  const std::unique_ptr<Ranks> ranks = launched_ranks();
  const TablePlan plan = plan_table(options);
  std::vector<DriveWork> works;
  std::optional<FolderLock> lock;
  ranks->rank_0_first([&] {
    if (ranks->rank() == 0) guard_tables(options);
    works = work_of(plan, options);
    if (ranks->rank() > 0) return;
    make_result_folder(options.out);
    lock.emplace(options.out);
  });
  const bool complete = run_missing(works, plan, options, interrupt, *ranks);
  if (ranks->rank() > 0) return complete ? kOk : kInterrupted;
  if (ranks->count() > 1) works = work_of(plan, options);  // with what the others have done
  const std::vector<DriveFigures> drives = figures_of(works, plan);
  if (const auto report = report_of(drives, plan)) {
    write_report(*report, options.out);
  } else if (complete) {
    throw Error(
        "no drive is long enough to be held against its truth, expected 3 scans; give more with "
        "--scans");
  }
  for (const DriveFigures& drive : drives) {
    if (drive.left_out.scans > 0)
      to_stderr("hqslam-lab: {}: {}\n", drive.name, drive.left_out.text());
  }
  if (complete) return kOk;
  to_stderr(
      "hqslam-lab: interrupted; what is finished is kept, the same command goes on from there\n");
  return kInterrupted;
}

}  // namespace hqslam::tools

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <filesystem>

#include "files/result_files.h"
#include "hqslam/core/error.h"
#include "laboratory.h"
#include "pages/page.h"
#include "table/table_plan.h"
#include "table/table_report.h"
#include "terminal/terminal.h"

namespace hqslam::tools {
namespace {

namespace fs = std::filesystem;

/// Throws Error if a table would replace other files.
void guard_tables(const TableOptions& options) {
  const fs::path folder(options.out);
  constexpr std::array<const char*, 3> kWritten = {"table.json", "table.md", "table.html"};
  guard_results(folder, kWritten, has_marker((folder / "table.json").string(), kTableJsonMarker),
                "was not written by hqslam-lab table", options.weights);
}

/// Returns false where no drive is finished.
bool write_report(const std::vector<DriveRuns>& runs, const TablePlan& plan) {
  std::vector<PartReport> parts;
  for (const TablePart& part : parts_of(plan, finished_drives(runs))) {
    parts.push_back(report_of(part));
  }
  if (parts.empty()) return false;
  const fs::path out(plan.out);
  to_stdout("{}", printed(parts));
  write_text_file(markdown_of(parts), (out / "table.md").string());
  write_text_file(json_of(parts), (out / "table.json").string());
  write_text_file(page_html("table", page_data(parts)), (out / "table.html").string());
  to_stdout("results: {0}/table.html, table.md and table.json\n", plan.out);
  return true;
}

}  // namespace

void declare(CLI::App& app, TableOptions& options) {
  Command command = add_command(
      app, "table",
      "Compare SLAM with 16 rows, with 16 upsampled to 64 by every method, and with 64",
      R"(METHOD+as-published in --methods or --weights, such as du-or+as-published, is a row with
LeGO-LOAM as its paper has it. Writes into --out:
  table.md, table.json, table.html  drift, slips and position errors; the page
                                    has maps of them
  results/DRIVE/METHOD-KEY.tum      trajectories of finished runs, for hqslam
                                    evaluate
  drives/NAME                       simulated drives, 320 MB for 1,000 scans
SLAM runs without loop closing; as many runs as there are threads share them. By default the
command takes hours and 3 GB: the drives have 12,000 scans, and Simple DU takes about a second for
each. Ctrl-C keeps finished runs; the same command then continues. A run is repeated for other
scans, with other weights and by another build of the program. Inertial data are not used.)");
  command
      .option("--drives", &options.drives,
              fmt::format("Simulated drives ({}) and recordings with {} rows (as for hqslam run), "
                          "separated by commas",
                          fmt::join(sim::drive_preset_names(), ", "), kTableAllRows),
              {.shows_default = true, .delimiter = ','})
      .option("--methods", &options.methods,
              fmt::format("Rows to compute, separated by commas (default: all of {})",
                          table_method_names()),
              {.delimiter = ','})
      .option("--weights", &options.weights,
              "Weights files, each an additional row: FILE.npz or FILE.npz+as-published",
              {.delimiter = ','})
      .option("--sensor", &options.reading.sensor,
              "Sensor of recordings that have no sensor.json (name or .json file)");
  declare_reading(command, options.reading);
  command
      .option("--scans", &options.scans, "Number of scans of each drive (default: all)",
              {.within = kAnyCount})
      .option("--sensor-errors", &options.sensor_errors,
              "Errors of the sensor of simulated drives, as for hqslam-lab simulate",
              {.shows_default = true, .one_of = sim::sensor_errors_names()})
      .option("--seeds", &options.seeds,
              "Seeds (1..10, or 3,5,8) from each of which every drive of --drives is simulated: "
              "the figures are means over the drives of a kind, with 95 % intervals")
      .option("--against", &options.against,
              "The row with which the others are compared drive by drive (default: linear or, "
              "without it, the first of --methods)")
      .option("--out", &options.out, "Folder for drives, results and tables", {.required = true});
  declare_threads(command, options.threads);
}

int run(const TableOptions& options) {
  use_threads(options.threads);
  const InterruptGuard interrupt;
  const TablePlan plan = plan_table(options);
  guard_tables(options);
  require_fitting_drives(plan);
  make_result_folder(options.out);
  const FolderLock lock(options.out);
  bool is_complete = simulate_missing(plan, interrupt);
  if (is_complete) {
    const std::vector<DriveRuns> runs = runs_of(plan);
    is_complete = run_missing(runs, plan, interrupt);
    if (!write_report(runs, plan) && is_complete) {
      throw Error(
          "expected drives of at least 3 scans whose true trajectory is known, or {} among "
          "--methods, found none; give more with --scans",
          kAllRows);
    }
  }
  if (is_complete) return kOk;
  to_stderr("hqslam-lab: interrupted; finished runs are kept, the same command continues\n");
  return kInterrupted;
}

void add_table(CLI::App& app, Chosen& chosen) { add_subcommand<TableOptions>(app, chosen); }

}  // namespace hqslam::tools

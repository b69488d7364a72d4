#include "table_command.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <omp.h>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <CLI/Validators.hpp>
#include <algorithm>
#include <filesystem>
#include <utility>

#include "content_hash.h"
#include "exit_status.h"
#include "hqslam/core/error.h"
#include "hqslam/core/png.h"
#include "hqslam/core/scan_source.h"
#include "interrupt.h"
#include "recording_sensor.h"
#include "report/table_report.h"
#include "table_drive.h"
#include "table_figures.h"
#include "table_json.h"
#include "table_markdown.h"
#include "table_run.h"
#include "text_file.h"

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

/// A drive whose recording is there.
struct PreparedDrive {
  TableDrive drive;
  SensorModel sensor;
  std::int64_t scans = 0;
  std::string results;  ///< folder
};

PreparedDrive prepared(const TableDrive& drive, const TableOptions& options) {
  PreparedDrive prepared;
  prepared.drive = drive;
  prepared.sensor = required_recording_sensor(drive.recording, drive.sensor);
  if (prepared.sensor.rows() != kTableAllRows) {
    throw Error(fmt::format("{}: expected a recording with {} rows, found '{}' with {}",
                            drive.recording, kTableAllRows, prepared.sensor.name,
                            prepared.sensor.rows()));
  }
  const std::int64_t size = open_recording(drive.recording, prepared.sensor)->size();
  prepared.scans = std::min(size, options.scans.value_or(size));
  prepared.results = (fs::path(options.out) / "results" / drive.name).string();
  return prepared;
}

TableSettings settings_of(const PreparedDrive& drive, const TableMethod& method) {
  TableSettings settings;
  settings.version = HQSLAM_VERSION;
  settings.recording = identity_of(drive.drive);
  settings.sensor = fmt::format("{} {}", drive.sensor.name, text_hash(sensor_json(drive.sensor)));
  settings.scans = drive.scans;
  settings.method = method.name;
  const std::string weights = weights_of(method, drive.sensor.name);
  if (!weights.empty()) {
    settings.weights = fs::path(weights).filename().string();
    settings.weights_hash = content_hash(weights);
  }
  return settings;
}

/// What is left to do on a drive.
std::vector<TablePass> passes_on(const PreparedDrive& drive,
                                 const std::vector<TableMethod>& methods) {
  std::vector<TableMethod> missing;
  for (const TableMethod& method : methods) {
    if (!load_result(settings_of(drive, method), drive.results)) missing.push_back(method);
  }
  std::vector<TablePass> passes;
  for (const std::vector<TableMethod>& shared : passes_of(missing)) {
    TablePass pass{drive.drive, drive.sensor, shared, {}, drive.scans, drive.drive.name};
    for (const TableMethod& method : shared) {
      pass.settings.push_back(settings_of(drive, method));
      pass.title += fmt::format("{} {}", pass.settings.size() == 1 ? "," : " and", method.title);
    }
    passes.push_back(std::move(pass));
  }
  return passes;
}

/// Runs what is missing. Returns false if it was interrupted.
bool run_missing(const std::vector<PreparedDrive>& drives, const std::vector<TableMethod>& methods,
                 const InterruptGuard& interrupt) {
  std::vector<std::pair<TablePass, std::string>> passes;
  for (const PreparedDrive& drive : drives) {
    for (TablePass& pass : passes_on(drive, methods)) {
      passes.emplace_back(std::move(pass), drive.results);
    }
  }
  for (std::size_t i = 0; i < passes.size(); ++i) {
    auto& [pass, folder] = passes[i];
    pass.title = fmt::format("{} of {}: {}", i + 1, passes.size(), pass.title);
    const std::vector<TableResult> results = run_pass(pass, interrupt);
    if (results.empty()) return false;
    for (const TableResult& result : results) save_result(result, folder);
  }
  return true;
}

/// Of everything that is there, whoever computed it.
DriveFigures figures_of(const PreparedDrive& drive, const std::vector<TableMethod>& shown) {
  std::vector<TableMethod> methods;
  std::vector<TableResult> results;
  for (const TableMethod& method : shown) {
    try {
      if (auto result = load_result(settings_of(drive, method), drive.results)) {
        methods.push_back(method);
        results.push_back(std::move(*result));
      }
    } catch (const Error&) {
      continue;  // no weights for this sensor: nothing can be there
    }
  }
  return drive_figures(drive.drive, drive.sensor.name, methods, results, truth_of(drive.drive));
}

void write_pictures(const DriveFigures& drive, const fs::path& out) {
  for (std::size_t i = 0; i < kLoopClosingNames.size(); ++i) {
    const ErrorMap map = error_map_of(drive, i);
    if (map.panels.empty()) continue;
    const std::string title =
        fmt::format("{}: {} scans, loop closing {}", drive.name, drive.scans, kLoopClosingNames[i]);
    write_png(
        error_map_image(map, title),
        (out / fmt::format("{}-loop-closing-{}.png", drive.name, kLoopClosingNames[i])).string());
  }
}

/// Throws Error if a table would replace what is none.
void refuse_foreign_tables(const std::string& out) {
  const fs::path folder(out);
  const std::string json = (folder / "table.json").string();
  refuse_to_replace_foreign(json, kTableJsonMarker);
  if (fs::exists(json)) return;
  for (const char* name : {"table.md", "table.html"}) {
    if (fs::exists(folder / name)) {
      throw Error(
          fmt::format("{}: is there already and was not written by hqslam table; give "
                      "another --out or move it",
                      (folder / name).string()));
    }
  }
}

void write_tables(const std::vector<DriveFigures>& drives, const fs::path& out) {
  write_text_file(table_markdown(drives), (out / "table.md").string());
  write_text_file(table_json(drives), (out / "table.json").string());
  write_text_file(table_html(drives), (out / "table.html").string());
  for (const DriveFigures& drive : drives) write_pictures(drive, out);
}

int report_interruption() {
  fmt::print(
      stderr,
      "hqslam: interrupted; what is finished is kept, the same command goes on from there\n");
  return kInterrupted;
}

}  // namespace

void declare_table(CLI::App& app, TableOptions& options) {
  CLI::App* command = app.add_subcommand(
      "table", "SLAM with 16 rows, with 16 lifted to 64 in every way, and with 64, in one table");
  command
      ->add_option("--drives", options.drives,
                   fmt::format("Simulated drives ({}) and recordings with {} rows (as for hqslam "
                               "run), separated by commas",
                               fmt::join(sim::drive_preset_names(), ", "), kTableAllRows))
      ->delimiter(',')
      ->capture_default_str();
  command
      ->add_option("--methods", options.methods,
                   fmt::format("Rows to compute, separated by commas (default: all of {})",
                               fmt::join(table_method_names(), ", ")))
      ->delimiter(',');
  command->add_option("--weights", options.weights, "Weights files that become rows of their own")
      ->delimiter(',');
  command->add_option("--sensor", options.sensor,
                      "Sensor of recordings that do not say theirs (name or .json file)");
  command
      ->add_option("--reference", options.reference,
                   "True trajectory of the recording in --drives (TUM, or KITTI with one pose per "
                   "scan)")
      ->check(CLI::ExistingFile);
  command->add_option("--scans", options.scans, "Only so many scans of each drive")
      ->check(CLI::Range(1, 1000000000));
  command->add_option("--out", options.out, "Folder for drives, results and tables")->required();
  command->add_option("--threads", options.threads, "Threads (default: all cores)")
      ->check(CLI::Range(1, 256));
  command->footer(
      variants_help() +
      "Writes into --out:\n"
      "  table.md, table.json, table.html   the tables; the page also shows where the error is\n"
      "  DRIVE-loop-closing-off.png, -on.png   trajectories coloured by error\n"
      "  results/DRIVE/METHOD.json, .tum    each finished run; drives/NAME: simulated drives\n"
      "Without a choice it takes hours and 3 GB: the drives have 12,000 scans, and Simple DU "
      "needs\n"
      "about a second for one. Ctrl-C keeps what is finished; the same command goes on from "
      "there.\n"
      "A result is computed anew if it is damaged or was made from another recording, with other\n"
      "weights or another version of the program.");
}

int table_command(const TableOptions& options) {
  if (options.threads > 0) omp_set_num_threads(options.threads);
  const InterruptGuard interrupt;
  const TablePlan plan = plan_table(options);
  refuse_foreign_tables(options.out);
  std::vector<PreparedDrive> drives;
  for (const TableDrive& drive : plan.drives) {
    if (!prepare_drive(drive, interrupt)) return report_interruption();
    drives.push_back(prepared(drive, options));
  }
  const bool complete = run_missing(drives, plan.methods, interrupt);
  std::vector<DriveFigures> figures;
  for (const PreparedDrive& drive : drives) {
    DriveFigures of_drive = figures_of(drive, plan.shown);
    if (!of_drive.methods.empty()) figures.push_back(std::move(of_drive));
  }
  if (!figures.empty()) {
    write_tables(figures, options.out);
    for (std::size_t i = 0; i < kLoopClosingNames.size(); ++i) {
      const TextTable table = paper_table(figures, i);
      fmt::print("{}\n\n{}\n", table.title, markdown_of(table));
    }
    fmt::print("results: {0}/table.html, table.md, table.json and pictures\n", options.out);
  }
  return complete ? kOk : report_interruption();
}

}  // namespace hqslam::tools

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "commands.h"
#include "files/result_folder.h"
#include "files/text_file.h"
#include "hqslam/core/error.h"
#include "hqslam/core/whole_file.h"
#include "laboratory/table/table_drive.h"
#include "laboratory/table/table_output.h"
#include "laboratory/table/table_work.h"
#include "ranks/launched_ranks.h"
#include "terminal/exit_status.h"
#include "terminal/interrupt.h"
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

void write_pictures(const DriveFigures& drive, const fs::path& out) {
  for (std::size_t i = 0; i < kLoopClosingNames.size(); ++i) {
    const ErrorMap map = error_map_of(drive, i);
    if (map.panels.empty()) continue;
    const std::string title =
        fmt::format("{}: {} scans, loop closing {}", drive.name, drive.scans, kLoopClosingNames[i]);
    write_whole_file(
        (out / fmt::format("{}-loop-closing-{}.svg", drive.name, kLoopClosingNames[i])).string(),
        error_map_svg(map, title));
  }
}

/// Throws Error if a table would replace what is none.
void refuse_foreign_tables(const std::string& out) {
  const fs::path folder(out);
  const std::string json = (folder / "table.json").string();
  refuse_to_replace_foreign(json, kTableJsonMarker);
  if (fs::exists(json)) return;
  refuse_existing(folder, std::array{"table.md", "table.html"},
                  "and was not written by hqslam table");
}

void write_pages(const std::string& markdown, const std::string& json, const std::string& html,
                 const fs::path& out) {
  write_text_file(markdown, (out / "table.md").string());
  write_text_file(json, (out / "table.json").string());
  write_text_file(html, (out / "table.html").string());
  to_stdout("results: {0}/table.html, table.md and table.json\n", out.string());
}

void print_table(const TextTable& table) {
  to_stdout("{}\n\n{}\n", table.title, markdown_of(table));
}

/// Of everything that is there.
void write_drives_tables(const std::vector<DriveWork>& works, const TablePlan& plan,
                         const fs::path& out) {
  std::vector<DriveFigures> drives;
  for (const DriveWork& work : works) {
    if (!work.prepared) continue;
    const FoundResults found = results_of(*work.prepared, plan.shown, plan.loop_closing);
    if (found.results.empty()) continue;
    drives.push_back(drive_figures(work.drive, work.prepared->sensor.name, found.methods,
                                   found.results, truth_of(work.drive)));
  }
  if (drives.empty()) return;
  for (std::size_t i = 0; i < kLoopClosingNames.size(); ++i) print_table(paper_table(drives, i));
  for (const DriveFigures& drive : drives) write_pictures(drive, out);
  write_pages(table_markdown(drives), table_json(drives), table_html(drives), out);
  for (const DriveFigures& drive : drives) {
    if (drive.left_out.scans > 0) to_stderr("hqslam: {}: {}\n", drive.name, drive.left_out.text());
  }
}

/// Of the drives that every method has finished.
void write_seeds_tables(const std::vector<DriveWork>& works, const TablePlan& plan,
                        const TableOptions& options) {
  SeedTable table;
  table.methods = plan.methods;
  const auto against =
      std::find_if(table.methods.begin(), table.methods.end(),
                   [&](const TableMethod& method) { return method.name == options.against; });
  table.against = static_cast<std::size_t>(against - table.methods.begin());
  for (const DriveWork& work : works) {
    if (!work.prepared) continue;
    const FoundResults found = results_of(*work.prepared, plan.methods, plan.loop_closing);
    if (found.results.size() < plan.methods.size()) continue;
    if (auto drive = seed_drive(work.drive, found.results, truth_of(work.drive)->poses)) {
      table.drives.push_back(std::move(*drive));
    }
  }
  if (table.drives.empty()) return;
  print_table(seeds_summary_table(table));
  print_table(seeds_pair_table(table));
  write_pages(seeds_markdown(table), seeds_json(table), seeds_html(table), options.out);
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
  command
      ->add_option("--weights", options.weights,
                   "Weights files that become rows of their own, FILE.npz or FILE.npz+VARIANT")
      ->delimiter(',');
  command->add_option("--sensor", options.reading.sensor,
                      "Sensor of recordings that do not say theirs (name or .json file)");
  declare_reading(*command, options.reading);
  command
      ->add_option("--reference", options.reference,
                   "True trajectory of the recording in --drives (TUM, or KITTI with one pose per "
                   "scan)")
      ->check(CLI::ExistingFile);
  command->add_option("--scans", options.scans, "Only so many scans of each drive")
      ->check(CLI::Range(1, 1000000000));
  CLI::Option* seeds =
      command->add_option("--seeds", options.seeds,
                          "Every simulated drive of --drives from each of these seeds (1..10, or "
                          "3,5,8) instead of once: "
                          "drift and slips against the truth, with 95 % intervals");
  command
      ->add_option("--against", options.against,
                   "With --seeds: the row that the others are paired with, drive by drive")
      ->needs(seeds)
      ->capture_default_str();
  command->add_option("--out", options.out, "Folder for drives, results and tables")->required();
  declare_threads(*command, options.threads);
  command->footer(
      variants_help() +
      "Writes into --out:\n"
      "  table.md, table.json, table.html   the tables; the page also shows where the error is\n"
      "  DRIVE-loop-closing-off.svg, -on.svg   trajectories coloured by error\n"
      "  results/DRIVE/.../METHOD.json, .tum   each finished run; drives/NAME: simulated drives\n"
      "Without a choice it takes hours and 3 GB: the drives have 12,000 scans, and Simple DU "
      "needs\n"
      "about a second for one. Ctrl-C keeps what is finished; the same command goes on from "
      "there.\n"
      "With --seeds there are no pictures, SLAM runs without loop closing, and as many drives as\n"
      "there are threads are under way side by side, with one thread each. A simulated drive of\n"
      "1,000 scans takes 320 MB.\n"
      "A result is computed anew if it is damaged or was made from a recording with other scans,\n"
      "with other weights or by another build of the program; results of other lengths and builds\n"
      "are kept beside it.\n"
      "mpirun -n N shares drives and methods among N processes, which must all see the same "
      "folders.");
}

int table_command(const TableOptions& options) {
  use_threads(options.threads);
  const InterruptGuard interrupt;
  const std::unique_ptr<Ranks> ranks = launched_ranks();
  const TablePlan plan = plan_table(options);
  std::vector<DriveWork> works;
  std::optional<FolderLock> lock;
  ranks->rank_0_first([&] {
    if (ranks->rank() == 0) refuse_foreign_tables(options.out);
    works = work_of(plan, options);
    if (ranks->rank() > 0) return;
    make_result_folder(options.out);
    lock.emplace(options.out);
  });
  const bool complete = run_missing(works, plan, options, interrupt, *ranks);
  if (ranks->rank() > 0) return complete ? kOk : kInterrupted;
  if (ranks->count() > 1) works = work_of(plan, options);  // with what the others have done
  if (plan.over_seeds) {
    write_seeds_tables(works, plan, options);
  } else {
    write_drives_tables(works, plan, options.out);
  }
  if (complete) return kOk;
  to_stderr("hqslam: interrupted; what is finished is kept, the same command goes on from there\n");
  return kInterrupted;
}

}  // namespace hqslam::tools

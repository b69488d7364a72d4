#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "compare/upsampling_comparison.h"
#include "files/result_files.h"
#include "hqslam/core/error.h"
#include "hqslam/core/npy.h"
#include "hqslam/core/point_fields.h"
#include "hqslam/evaluation/trajectory_error.h"
#include "laboratory.h"
#include "pages/open_page.h"
#include "pages/page.h"
#include "pages/text_table.h"
#include "pages/turning_view.h"
#include "recording/reading.h"
#include "recording/recording_choice.h"
#include "run/report_page.h"
#include "run/run_command.h"
#include "simulate/simulate_command.h"
#include "terminal/command_options.h"
#include "terminal/progress.h"
#include "terminal/terminal.h"

namespace hqslam::tools {
namespace {

struct DemoOptions {
  std::string out = "hqslam-demo";
  bool open = false;
};

constexpr const char* kWeights = "du-mix_any-beams.npz";
constexpr int kFewRows = 16;
/// Image errors are means over every n-th scan.
constexpr std::int64_t kComparedScans = 10;

/// One input of SLAM made from the drive.
struct DemoInput {
  std::string name;
  std::string folder;    ///< of its results
  int rows = 0;          ///< of the recording that are used
  std::string upsample;  ///< as RunOptions::upsample
  bool dense_map = false;
};

struct DemoRow {
  DemoInput input;
  SlamRun run;
  std::optional<UpsamplingScore> score;  ///< of inputs that are upsampled
};

std::vector<DemoInput> inputs_with(const std::optional<std::string>& weights) {
  std::vector<DemoInput> result = {{"64 beams", "rows-64", 64, ""},
                                   {"16 beams", "rows-16", kFewRows, "", true},
                                   {"16 -> 64, linear", "linear", kFewRows, "linear"}};
  if (weights) {
    result.push_back({"16 -> 64, DU-Mix", "du-mix", kFewRows, *weights, true});
  }
  return result;
}

/// Scores the upsampled inputs against the drive's 64 rows.
void score(const std::string& drive, std::vector<DemoRow>& rows, const InterruptGuard& interrupt) {
  std::vector<ComparedMethod> methods;
  for (const DemoRow& row : rows) {
    if (!row.input.upsample.empty()) {
      pipeline::UpsampledRecording input =
          upsampled_recording({drive}, {row.input.upsample, row.input.rows});
      methods.push_back({row.input.name, std::move(*input.upsampler.method())});
    }
  }
  UpsamplingComparison comparison(std::move(methods));
  auto source = recordings::Recording::open(drive);
  Progress progress("compare with 64 beams", source.size());
  Reading reading;
  read_scans(source, interrupt, reading, [&](const ReadScan& read) {
    if (read.index % kComparedScans == 0) comparison.add(read.scan.cloud);
    progress.update(read.index + 1);
    return true;
  });
  progress.finish();
  for (const UpsamplingScore& result : comparison.scores()) {
    for (DemoRow& row : rows) {
      if (row.input.name == result.method) row.score = result;
    }
  }
}

std::string ape_text(const SlamRun& run) {
  return run.comparison ? fmt::format("{:.3f}", run.comparison->error.translation_statistics.rmse)
                        : "-";
}

/// The four columns about the images.
std::vector<std::string> score_cells(const std::optional<UpsamplingScore>& score) {
  if (!score) return {"-", "-", "-", "-"};
  return {fmt::format("{:.3f}", score->mae_all_m), fmt::format("{:.3f}", score->mae_valid_m),
          fmt::format("{:.2f} %", 100.0 * score->outlier_share),
          fmt::format("{:.0f}", 1e3 / score->upsampling_ms)};
}

TextTable table_of(const std::vector<DemoRow>& rows) {
  TextTable table{.columns = {"", "scans", "APE, m", "MAE all, m", "MAE valid, m", "outliers",
                              "upsampling, scans/s", "SLAM, ms", "all, scans/s"}};
  for (const DemoRow& row : rows) {
    const SlamRun& run = row.run;
    std::vector<std::string>& cells = table.rows.emplace_back();
    cells = {row.input.name, fmt::format("{}", run.scans.size()), ape_text(run)};
    std::ranges::copy(score_cells(row.score), std::back_inserter(cells));
    cells.push_back(fmt::format("{:.1f}", statistics_of(slam_times(run).times_ms).median));
    cells.push_back(fmt::format("{:.1f}", scans_per_second(run)));
    table.links.push_back(row.input.folder + "/report.html");
  }
  return table;
}

std::vector<std::string> notes_of(const std::vector<DemoRow>& rows) {
  return {
      fmt::format("APE: absolute pose error (RMSE) against the true trajectory, SE(3)-aligned; the "
                  "path is {:.0f} m",
                  path_length_m(rows.front().run.trajectory)),
      "MAE: mean |range - true range|, over all pixels and over those where both have a return",
      "outliers: share of points farther than 0.5 m from the cloud of 64 beams",
      "upsampling: alone, without reading; all: reading, upsampling and SLAM"};
}

/// The scan in the middle of the drive in every input.
std::vector<std::pair<std::string, RangeImage>> example_images(const std::string& drive,
                                                               const std::vector<DemoRow>& rows) {
  NpyStackReader stack(drive + "/scans.npy");
  const RangeImage truth = stack.read(stack.images() / 2);
  std::vector<std::pair<std::string, RangeImage>> images;
  for (const DemoRow& row : rows) {
    const RowSelection seen = selection_for(truth.rows, row.input.rows);
    if (row.input.upsample.empty()) {
      images.emplace_back(row.input.name, select_rows(truth, seen));
      continue;
    }
    pipeline::UpsampledRecording input =
        upsampled_recording({drive}, {row.input.upsample, row.input.rows});
    images.emplace_back(row.input.name,
                        input.upsampler.method()->run(select_rows(truth, seen)).image);
  }
  return images;
}

/// The path and the scans of the last input over the dense maps.
TurningView view_of(const std::filesystem::path& out, const std::vector<DemoRow>& rows) {
  TurningView view = view_of(rows.back().run);
  view.clouds.clear();
  for (const DemoRow& row : rows) {
    if (!row.input.dense_map) continue;
    RawPoints map = read_point_file((out / row.input.folder / "dense_map.pcd").string());
    view.clouds.insert(view.clouds.begin(), {row.input.name, std::move(map.scan.points_m),
                                             std::move(map.scan.confidence)});
  }
  return view;
}

/// tools/web/demo.html: the view, the table with its notes, whose rows lead to the reports of the
/// runs, and one scan in every form that SLAM was given.
std::string demo_html(const TurningView& view, const TextTable& table,
                      const std::vector<std::string>& notes,
                      const std::vector<std::pair<std::string, RangeImage>>& images,
                      double max_range_m) {
  PageJson data = {{"title", "One drive, four ways"},
                   {"subtitle",
                    "A drive through a simulated city with 64 beams, with 16, and with "
                    "16 upsampled to 64"},
                   {"view", turning_view_json(view)},
                   {"table", json_of(table)},
                   {"notes", notes},
                   {"max_range_m", max_range_m},
                   {"images", PageJson::array()}};
  for (const auto& [caption, image] : images) {
    data["images"].push_back({{"caption", caption},
                              {"rows", image.rows},
                              {"columns", image.columns},
                              {"ranges", range_block(image)}});
  }
  return page_html("demo", std::move(data));
}

void declare(CLI::App& app, DemoOptions& options) {
  Command command = add_command(
      app, "demo",
      "Simulate a short city drive and run SLAM on it with 64 beams, with 16, and with 16 "
      "upsampled to 64");
  command.option("--out", &options.out, "Folder for the drive and the results",
                 {.shows_default = true});
  declare_open(command, options.open);
}

int run(const DemoOptions& options) {
  namespace fs = std::filesystem;
  const InterruptGuard interrupt;
  const auto interrupted = [] {
    to_stderr("hqslam-lab: interrupted\n");
    return kInterrupted;
  };
  const fs::path out = fs::absolute(options.out).lexically_normal();
  constexpr std::array<const char*, 1> kPage = {"demo.html"};
  guard_results(out, kPage, has_marker((out / kPage[0]).string(), page_marker("hqslam-lab demo")),
                "was not written by hqslam-lab demo");
  SimulateOptions simulate;
  simulate.drive = "block";
  simulate.sensor = "os1-64";
  simulate.out = (out / "drive").string();
  if (simulate_drive(simulate, interrupt) == kInterrupted) return interrupted();

  const std::optional<std::string> weights = pipeline::installed_weights(kWeights);
  std::vector<DemoRow> rows;
  for (const DemoInput& input : inputs_with(weights)) {
    RunOptions run;
    run.input = simulate.out;
    run.rows = input.rows;
    run.upsample = input.upsample;
    run.dense_map = input.dense_map;
    run.out = (out / input.folder).string();
    run.no_calibration = true;  // the rows compare the same beams
    rows.push_back({input, run_and_write(run, interrupt), std::nullopt});
    const std::vector<std::string>& failed = rows.back().run.failed_maps;
    if (!failed.empty()) throw Error("{}", failed.front());
    if (rows.back().run.end == ReadingEnd::kInterrupted) return interrupted();
  }
  score(simulate.out, rows, interrupt);
  if (interrupt.stop_requested()) return interrupted();
  to_stdout("A drive of {} scans through a simulated city, sensor {}.\n\n",
            *rows.front().run.scans_in_recording, simulate.sensor);
  const TextTable table = table_of(rows);
  const std::vector<std::string> notes = notes_of(rows);
  to_stdout("{}{}\n\n", printed_table(table), fmt::join(notes, "\n"));
  if (!weights) {
    to_stdout("DU-Mix was left out: its weights, weights/{}, were not found.\n\n", kWeights);
  }
  const double max_range_m = recordings::Recording::open(simulate.out).sensor().max_range_m;
  const std::string page = (out / kPage[0]).string();
  write_text_file(
      demo_html(view_of(out, rows), table, notes, example_images(simulate.out, rows), max_range_m),
      page);
  to_stdout("Pages for any browser:\n  {}\n", page);
  for (const std::string& report : table.links) to_stdout("  {}\n", (out / report).string());
  if (options.open) open_page(page);
  return kOk;
}

}  // namespace

void add_demo(CLI::App& app, Chosen& chosen) { add_subcommand<DemoOptions>(app, chosen); }

}  // namespace hqslam::tools

#include "table/table_work.h"

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "files/content_hash.h"
#include "hqslam/core/error.h"
#include "hqslam/core/scan_source.h"
#include "hqslam/nn/compare/compared_networks.h"
#include "recording/recording_choice.h"
#include "side_by_side/side_by_side.h"
#include "table/result_sources_hash.h"
#include "table/table_drive.h"
#include "terminal/progress.h"

namespace hqslam::tools {
namespace {

namespace fs = std::filesystem;

recordings::Recording recording_of(const TableDrive& drive) {
  return recordings::Recording::open(drive.recording.input, open_options(drive.recording));
}

SensorModel sensor_of(const TableDrive& drive) {
  SensorModel sensor = recording_of(drive).sensor();
  if (sensor.rows() == kTableAllRows) return sensor;
  throw Error(
      "{}: expected a recording with {} rows, found sensor '{}' with {}; give another of --drives, "
      "or --sensor",
      drive.recording.input, kTableAllRows, sensor.name, sensor.rows());
}

/// Throws Error, before the work, for weights that cannot upsample the drive.
void require_weights(const SensorModel& sensor, const TableDrive& drive, const TablePlan& plan) {
  for (const TableMethod& method : plan.methods) {
    const std::string weights = weights_of(method, sensor.name);
    if (weights.empty()) continue;
    pipeline::UpsamplingOptions options{weights, method.rows};
    options.network.architectures = nn::all_architectures();
    pipeline::Upsampler(sensor, options, drive.name);
  }
}

/// The folder of a drive's results, which depends on the number of scans and on the build.
std::string result_folder(const TableDrive& drive, std::int64_t scans, const std::string& out) {
  constexpr std::size_t kDigits = 8;
  return (fs::path(out) / "results" / drive.name /
          fmt::format("{}-scans-build-{}", scans, result_sources_hash().substr(0, kDigits)))
      .string();
}

TableSettings settings_of(const DriveWork& work, const TableMethod& method, const TablePlan& plan) {
  TableSettings settings;
  settings.build = result_sources_hash();
  settings.recording = work.identity;
  settings.sensor = fmt::format("{} {}", work.sensor.name, text_hash(sensor_json(work.sensor)));
  settings.scans = work.scans;
  settings.loop_closing = !plan.over_seeds;
  settings.method = method.name;
  const std::string weights = weights_of(method, work.sensor.name);
  if (!weights.empty()) {
    settings.weights = fs::path(weights).filename().string();
    settings.weights_hash = content_hash(weights);
  }
  return settings;
}

/// Fills in what depends on the drive's recording, which exists.
void prepare(DriveWork& work, const TablePlan& plan, const TableOptions& options) {
  work.sensor = sensor_of(work.drive);
  const std::int64_t size = scans_in(work.drive.recording, recording_of(work.drive));
  work.scans = std::min(size, options.scans.value_or(size));
  work.identity = identity_of(work.drive, work.scans);
  work.results = result_folder(work.drive, work.scans, options.out);
  work.is_prepared = true;
  std::vector<TableMethod> missing;
  for (const TableMethod& method : plan.methods) {
    if (!load_result(settings_of(work, method, plan), work.results)) missing.push_back(method);
  }
  for (const std::vector<TableMethod>& shared : passes_of(missing)) {
    TablePass& pass = work.passes.emplace_back();
    for (const TableMethod& method : shared) {
      pass.push_back({method, settings_of(work, method, plan)});
    }
  }
}

/// Scans to be simulated and to be processed.
std::int64_t scans_left(const std::vector<DriveWork>& works, const TablePlan& plan) {
  std::int64_t scans = 0;
  for (const DriveWork& work : works) {
    scans += work.is_prepared
                 ? std::ssize(work.passes) * work.scans
                 : (1 + std::ssize(passes_of(plan.methods))) * work.drive.simulated->scans;
  }
  return scans;
}

std::string title_of(const DriveWork& work, const TablePass& pass) {
  std::string title = work.drive.name;
  for (const TableRun& run : pass) {
    title += fmt::format("{} {}", &run == &pass.front() ? "," : " and", run.method.title);
  }
  return title;
}

/// Runs what is missing on a drive. Returns false if it was interrupted.
bool run_drive(DriveWork& work, const TablePlan& plan, const TableOptions& options,
               const InterruptGuard& interrupt, Progress& progress) {
  const auto advance = [&] { progress.advance(); };
  if (!work.is_prepared) {
    progress.relabel(fmt::format("{}, simulated", work.drive.name));
    if (!prepare_drive(work.drive, interrupt, advance)) return false;
    prepare(work, plan, options);
  }
  for (const TablePass& pass : work.passes) {
    progress.relabel(title_of(work, pass));
    const std::vector<TableResult> results = run_pass(
        work, pass, plan.over_seeds ? kScoredPerSeed : kMostScoredScans, interrupt, advance);
    if (results.empty()) return false;
    for (const TableResult& result : results) save_result(result, work.results);
  }
  return true;
}

}  // namespace

std::vector<DriveWork> work_of(const TablePlan& plan, const TableOptions& options) {
  bool simulated = false;  // all simulated drives have one sensor
  for (const TableDrive& drive : plan.drives) {
    if (drive.simulated && simulated) continue;
    simulated = drive.simulated || simulated;
    require_weights(drive.simulated ? load_sensor(kSimulatedSensor) : sensor_of(drive), drive,
                    plan);
  }
  std::vector<DriveWork> works;
  for (const TableDrive& drive : plan.drives) {
    DriveWork& work = works.emplace_back();
    work.drive = drive;
    if (is_there(drive)) prepare(work, plan, options);
  }
  return works;
}

bool run_missing(std::vector<DriveWork>& works, const TablePlan& plan, const TableOptions& options,
                 const InterruptGuard& interrupt) {
  const std::int64_t scans = scans_left(works, plan);
  if (scans == 0) return true;
  Progress progress("table", scans);
  const int threads = omp_get_max_threads();
  const bool complete =
      side_by_side(works.size(), plan.over_seeds ? threads : 1, plan.over_seeds ? 1 : threads,
                   [&](std::size_t i, const std::atomic<bool>&) {
                     return run_drive(works[i], plan, options, interrupt, progress);
                   });
  progress.finish();
  return complete;
}

std::vector<TableResult> results_of(const DriveWork& work, const TablePlan& plan) {
  std::vector<TableResult> results;
  for (const TableMethod& method : plan.shown) {
    try {
      if (auto result = load_result(settings_of(work, method, plan), work.results)) {
        result->method = method;
        results.push_back(std::move(*result));
      }
    } catch (const Error&) {
      continue;  // no weights for this sensor, so no result
    }
  }
  return results;
}

}  // namespace hqslam::tools

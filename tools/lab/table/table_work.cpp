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

SensorModel sensor_of(const TableDrive& drive) {
  const InputChoice& recording = drive.recording;
  SensorModel sensor =
      recordings::Recording::open(recording.input, open_options(recording)).sensor();
  if (sensor.rows() == kTableAllRows) return sensor;
  throw Error(
      "{}: expected a recording with {} rows, found sensor '{}' with {}; give another of --drives, "
      "or --sensor",
      recording.input, kTableAllRows, sensor.name, sensor.rows());
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

PreparedDrive prepared(const TableDrive& drive, const TableOptions& options) {
  const SensorModel sensor = sensor_of(drive);
  const std::int64_t size =
      scans_in(drive.recording,
               recordings::Recording::open(drive.recording.input, open_options(drive.recording)));
  const std::int64_t scans = std::min(size, options.scans.value_or(size));
  return {
      {drive}, sensor, scans, identity_of(drive, scans), result_folder(drive, scans, options.out)};
}

TableSettings settings_of(const PreparedDrive& drive, const TableMethod& method,
                          bool loop_closing) {
  TableSettings settings;
  settings.build = result_sources_hash();
  settings.recording = drive.identity;
  settings.sensor = fmt::format("{} {}", drive.sensor.name, text_hash(sensor_json(drive.sensor)));
  settings.scans = drive.scans;
  settings.loop_closing = loop_closing;
  settings.method = method.name;
  const std::string weights = weights_of(method, drive.sensor.name);
  if (!weights.empty()) {
    settings.weights = fs::path(weights).filename().string();
    settings.weights_hash = content_hash(weights);
  }
  return settings;
}

/// The passes that are left on a drive.
std::vector<TablePass> passes_on(const PreparedDrive& drive, const TablePlan& plan) {
  std::vector<TableMethod> missing;
  for (const TableMethod& method : plan.methods) {
    if (!load_result(settings_of(drive, method, plan.loop_closing), drive.results)) {
      missing.push_back(method);
    }
  }
  std::vector<TablePass> passes;
  for (const std::vector<TableMethod>& shared : passes_of(missing)) {
    TablePass pass{
        drive, shared, {}, plan.loop_closing, plan.over_seeds ? kScoredPerSeed : kMostScoredScans};
    for (const TableMethod& method : shared) {
      pass.settings.push_back(settings_of(drive, method, plan.loop_closing));
    }
    passes.push_back(std::move(pass));
  }
  return passes;
}

/// Scans to be simulated and to be processed.
std::int64_t scans_left(const std::vector<DriveWork>& works, const TablePlan& plan) {
  std::int64_t scans = 0;
  for (const DriveWork& work : works) {
    if (work.prepared) {
      scans += static_cast<std::int64_t>(work.passes.size()) * work.prepared->scans;
    } else {
      scans += static_cast<std::int64_t>(1 + passes_of(plan.methods).size()) *
               work.drive.simulated->scans;
    }
  }
  return scans;
}

std::string title_of(const TablePass& pass) {
  std::string title = pass.drive.name;
  for (std::size_t i = 0; i < pass.methods.size(); ++i) {
    title += fmt::format("{} {}", i == 0 ? "," : " and", pass.methods[i].title);
  }
  return title;
}

/// Returns false if it was interrupted.
bool simulate_drive(const TableDrive& drive, const InterruptGuard& interrupt, Progress& progress) {
  progress.relabel(fmt::format("{}, simulated", drive.name));
  return prepare_drive(drive, interrupt, [&] { progress.advance(); });
}

/// Runs what is missing on a drive. Returns false if it was interrupted.
bool run_drive(DriveWork& work, const TablePlan& plan, const TableOptions& options,
               const InterruptGuard& interrupt, Progress& progress) {
  if (!work.prepared) {
    if (!simulate_drive(work.drive, interrupt, progress)) return false;
    work.prepared = prepared(work.drive, options);
    work.passes = passes_on(*work.prepared, plan);
  }
  for (const TablePass& pass : work.passes) {
    progress.relabel(title_of(pass));
    const std::vector<TableResult> results = run_pass(pass, interrupt, [&] { progress.advance(); });
    if (results.empty()) return false;
    for (const TableResult& result : results) save_result(result, work.prepared->results);
  }
  return true;
}

}  // namespace

std::vector<DriveWork> work_of(const TablePlan& plan, const TableOptions& options) {
  std::vector<DriveWork> works;
  // Before anything is written; all simulated drives have one sensor.
  bool simulated = false;
  for (const TableDrive& drive : plan.drives) {
    if (drive.simulated && simulated) continue;
    simulated = drive.simulated || simulated;
    require_weights(drive.simulated ? load_sensor(kSimulatedSensor) : sensor_of(drive), drive,
                    plan);
  }
  for (const TableDrive& drive : plan.drives) {
    DriveWork work{drive, std::nullopt, {}};
    if (is_there(drive)) {
      work.prepared = prepared(drive, options);
      work.passes = passes_on(*work.prepared, plan);
    }
    works.push_back(std::move(work));
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

FoundResults results_of(const PreparedDrive& drive, const std::vector<TableMethod>& methods,
                        bool loop_closing) {
  FoundResults found;
  for (const TableMethod& method : methods) {
    try {
      if (auto result = load_result(settings_of(drive, method, loop_closing), drive.results)) {
        found.methods.push_back(method);
        found.results.push_back(std::move(*result));
      }
    } catch (const Error&) {
      continue;  // no weights for this sensor, so no result
    }
  }
  return found;
}

}  // namespace hqslam::tools

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
#include "ranks/ranks.h"
#include "recording/recording_choice.h"
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

/// Does the job on all drives: one after the other or, over seeds, in parallel on as many drives as
/// OpenMP has threads, with one thread each. `scans`: of all drives together. Returns false if it
/// was interrupted.
bool on_drives(std::vector<DriveWork>& works, const TablePlan& plan, std::int64_t scans,
               const std::function<bool(DriveWork&, Progress&)>& job) {
  if (scans == 0) return true;
  Progress progress("table", scans);
  const int threads = omp_get_max_threads();
  const bool complete = side_by_side(
      works.size(), plan.over_seeds ? threads : 1, plan.over_seeds ? 1 : threads,
      [&](std::size_t i, const std::atomic<bool>&) { return job(works[i], progress); });
  progress.finish();
  return complete;
}

bool run_drives(std::vector<DriveWork>& works, const TablePlan& plan, const TableOptions& options,
                const InterruptGuard& interrupt) {
  return on_drives(works, plan, scans_left(works, plan), [&](DriveWork& work, Progress& progress) {
    return run_drive(work, plan, options, interrupt, progress);
  });
}

/// This rank's share of the drives that are to be simulated.
std::vector<DriveWork> own_simulations(const std::vector<DriveWork>& works, const Ranks& ranks) {
  std::vector<DriveWork> own;
  for (std::size_t i = 0; i < works.size(); ++i) {
    if (is_own(i, ranks) && !works[i].prepared) own.push_back(works[i]);
  }
  return own;
}

/// Removes the passes of other ranks. A pass is assigned by its place in the whole plan, all drives
/// of one kind of pass after the other: every rank gets an equal number of slow passes, and the
/// assignment does not change as passes are finished.
void keep_own_passes(std::vector<DriveWork>& works, const TablePlan& plan, const Ranks& ranks) {
  const std::vector<std::vector<TableMethod>> kinds = passes_of(plan.methods);
  for (std::size_t drive = 0; drive < works.size(); ++drive) {
    std::erase_if(works[drive].passes, [&](const TablePass& pass) {
      const auto kind = std::ranges::find_if(kinds, [&](const auto& methods) {
        return shares_pass(methods.front(), pass.methods.front());
      });
      const auto place = static_cast<std::size_t>(kind - kinds.begin());
      return !is_own(place * works.size() + drive, ranks);
    });
  }
}

/// Simulates drives; returns false if it was interrupted.
bool simulate_drives(std::vector<DriveWork>& works, const TablePlan& plan,
                     const InterruptGuard& interrupt) {
  std::int64_t scans = 0;
  for (const DriveWork& work : works) scans += work.drive.simulated->scans;
  return on_drives(works, plan, scans, [&](DriveWork& work, Progress& progress) {
    return simulate_drive(work.drive, interrupt, progress);
  });
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
                 const InterruptGuard& interrupt, Ranks& ranks) {
  if (ranks.count() == 1) return run_drives(works, plan, options, interrupt);
  std::vector<DriveWork> simulations = own_simulations(works, ranks);
  if (ranks.any(!simulate_drives(simulations, plan, interrupt))) return false;
  works = work_of(plan, options);
  keep_own_passes(works, plan, ranks);
  return !ranks.any(!run_drives(works, plan, options, interrupt));
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

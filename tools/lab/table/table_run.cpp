#include "table/table_run.h"

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <functional>
#include <tuple>

#include "files/content_hash.h"
#include "files/result_files.h"
#include "hqslam/core/error.h"
#include "hqslam/core/npy.h"
#include "hqslam/core/whole_file.h"
#include "hqslam/pipeline/drive_memory.h"
#include "recording/reading.h"
#include "side_by_side/side_by_side.h"
#include "simulate/simulate_command.h"
#include "terminal/progress.h"

namespace hqslam::tools {
namespace {

namespace fs = std::filesystem;

/// As many jobs side by side as OpenMP has threads, which they share.
bool do_jobs(std::size_t jobs, const std::function<bool(std::size_t)>& job) {
  const int threads = omp_get_max_threads();
  const int workers = std::clamp(static_cast<int>(jobs), 1, threads);
  return side_by_side(jobs, workers, threads / workers,
                      [&](std::size_t i, const std::atomic<bool>&) { return job(i); });
}

/// Whether a folder has a simulated drive, complete and long enough.
bool is_simulated(const TableDrive& drive) {
  const std::string& folder = drive.recording.input;
  try {
    sim::DriveSpec found = sim::read_drive_json(folder + "/drive.json");
    const bool is_complete = NpyStackReader(folder + "/scans.npy").images() == found.scans &&
                             std::ssize(read_tum(folder + "/truth.tum")) == found.scans;
    const bool is_long = found.scans >= drive.simulated->scans;
    const bool has_sensor = sensor_json(load_sensor(folder + "/sensor.json")) ==
                            sensor_json(load_sensor(kSimulatedSensor));
    found.scans = drive.simulated->scans;
    return is_complete && is_long && has_sensor && found == *drive.simulated;
  } catch (const Error&) {
    return false;
  }
}

/// Changes with the scans of a recording, wherever it is, and with how they are read.
std::string recording_key(const TableDrive& drive) {
  const InputChoice& reading = drive.recording;
  const fs::path input(reading.input);
  if (drive.simulated) return content_hash(input / "drive.json");  // determines every byte
  std::string key =
      fs::is_directory(input) ? folder_hash(input.string()) : content_hash(input.string());
  const std::string beside = (input / "../timestamps.txt").string();  // as in KITTI's drives
  for (const std::string& times : {beside, reading.stamps}) {
    std::error_code error;
    if (fs::is_regular_file(times, error)) key += content_hash(times);
  }
  return fmt::format("{} {} {} {} {} {}", key, reading.stream, reading.kept_return,
                     reading.row_order, reading.capture, reading.stamps);
}

std::string weights_key(const TableMethod& method) {
  const std::string& source = method.source;
  if (fs::path(source).extension() == ".npz") return content_hash(source);
  std::string key = source + " ";  // an interpolation or a name
  for (const std::string& file : pipeline::installed_weights_files(source)) {
    key += content_hash(file);
  }
  return key;
}

std::optional<Trajectory> finished_run(const std::string& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return std::nullopt;
  try {
    return read_tum(path);
  } catch (const Error&) {
    return std::nullopt;  // damaged: run again
  }
}

/// SLAM works with a clock that is set back; a comparison of trajectories by stamps does not.
void require_rising(const RecordedScan& scan, const Trajectory& before) {
  if (before.empty() || scan.stamp_s > before.back().stamp_s) return;
  throw Error(
      "{}: expected a stamp after that of the scan before, {:.6f} s, found {:.6f} s; give rising "
      "stamps with --stamps",
      scan.name, before.back().stamp_s, scan.stamp_s);
}

/// Returns false if it was interrupted.
bool run_method(const DriveRuns& runs, const TableMethod& method, const std::string& path,
                const InterruptGuard& interrupt, Progress& progress) {
  const InputChoice& input = runs.drive.recording;
  auto [_, options, recording, upsampler] =
      pipeline::open_upsampled(input.input, open_options(input), upsampling_of(method));
  pipeline::DriveMemory memory(upsampler.method());
  const SlamSetup setup = slam_setup(method, upsampler.sensor());
  pipeline::Pipeline slam(setup.sensor, setup.options);
  Reading reading;
  read_scans(recording, interrupt, reading, [&](const ReadScan& read) {
    const auto& [cloud, stamp_s] = std::tie(read.scan.cloud, read.scan.stamp_s);
    require_rising(read.scan, slam.trajectory());
    const OrganizedCloud measured = upsampler.measured(cloud);
    const nn::RecalledImage recalled = memory.recall(measured, slam.trajectory(), stamp_s);
    const slam::ScanReport report =
        slam.process(upsampler.upsampled(measured, recalled), stamp_s).report;
    memory.insert(measured, slam.trajectory(), slam::is_registered(report.mapping_status));
    progress.advance();
    return std::ssize(slam.trajectory()) < runs.scans;
  });
  if (reading.end == ReadingEnd::kInterrupted) return false;
  if (reading.end == ReadingEnd::kUnreadableScan) throw Error(reading.end_message);
  if (reading.left_out.scans > 0) {
    to_stderr("hqslam-lab: {}: {}\n", runs.drive.name, reading.left_out.text());
  }
  slam.finish();
  replace_file(path, [&](const std::string& part) { write_tum(slam.trajectory(), part); });
  return true;
}

}  // namespace

bool simulate_missing(const TablePlan& plan, const InterruptGuard& interrupt) {
  std::vector<const TableDrive*> missing;
  std::int64_t scans = 0;
  for (const TableDrive& drive : plan.drives) {
    if (!drive.simulated || is_simulated(drive)) continue;
    missing.push_back(&drive);
    scans += drive.simulated->scans;
  }
  if (missing.empty()) return true;
  Progress progress("simulate", scans);
  const bool is_complete = do_jobs(missing.size(), [&](std::size_t i) {
    progress.relabel(fmt::format("simulate {}", missing[i]->name));
    const auto advance = [&] { progress.advance(); };
    return simulate_drive(*missing[i]->simulated, kSimulatedSensor, missing[i]->recording.input,
                          interrupt, advance) == kOk;
  });
  progress.finish();
  return is_complete;
}

std::vector<DriveRuns> runs_of(const TablePlan& plan) {
  std::vector<std::string> weights;
  for (const TableMethod& method : plan.methods) weights.push_back(weights_key(method));
  std::vector<DriveRuns> all;
  for (const TableDrive& drive : plan.drives) {
    DriveRuns& runs = all.emplace_back(DriveRuns{drive, 0, {}});
    const InputChoice& input = drive.recording;
    const auto recording = recordings::Recording::open(input.input, open_options(input));
    const std::int64_t size = scans_in(input, recording);
    runs.scans = std::min(size, plan.scans.value_or(size));
    const std::string key =
        fmt::format("{} {} {} {}", program_hash(), sensor_json(recording.sensor()), runs.scans,
                    recording_key(drive));
    const fs::path folder = fs::path(plan.out) / "results" / drive.name;
    for (std::size_t i = 0; i < plan.methods.size(); ++i) {
      const std::string hash = text_hash(fmt::format("{} {}", key, weights[i]));
      runs.paths.push_back(folder / fmt::format("{}-{}.tum", plan.methods[i].name, hash));
    }
  }
  return all;
}

bool run_missing(const std::vector<DriveRuns>& runs, const TablePlan& plan,
                 const InterruptGuard& interrupt) {
  struct Missing {
    const DriveRuns* runs;
    std::size_t method;
  };
  std::vector<Missing> missing;
  std::int64_t scans = 0;
  for (const DriveRuns& drive : runs) {
    for (std::size_t method = 0; method < drive.paths.size(); ++method) {
      if (finished_run(drive.paths[method])) continue;
      missing.push_back({&drive, method});
      scans += drive.scans;
    }
  }
  if (missing.empty()) return true;
  Progress progress("table", scans);
  const bool is_complete = do_jobs(missing.size(), [&](std::size_t i) {
    const auto& [drive, method] = missing[i];
    const std::string& path = drive->paths[method];
    make_result_folder(fs::path(path).parent_path());
    progress.relabel(fmt::format("{}, {}", drive->drive.name, plan.methods[method].title));
    return run_method(*drive, plan.methods[method], path, interrupt, progress);
  });
  progress.finish();
  return is_complete;
}

std::vector<FinishedDrive> finished_drives(const std::vector<DriveRuns>& runs) {
  std::vector<FinishedDrive> finished;
  for (const DriveRuns& drive : runs) {
    FinishedDrive all{drive.drive, drive.scans, {}, {}};
    for (const std::string& path : drive.paths) {
      if (auto trajectory = finished_run(path)) all.trajectories.push_back(std::move(*trajectory));
    }
    if (all.trajectories.size() < drive.paths.size()) continue;
    const std::string truth = file_of_drive(drive.drive.recording.input, "truth.tum");
    if (!truth.empty()) all.truth = read_tum(truth);
    finished.push_back(std::move(all));
  }
  return finished;
}

std::string program_hash() {
  static const std::string hash = content_hash("/proc/self/exe");
  return hash;
}

}  // namespace hqslam::tools

#include "train/drive_store.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <functional>
#include <nlohmann/json.hpp>
#include <set>

#include "files/content_hash.h"
#include "files/result_files.h"
#include "hqslam/core/error.h"
#include "hqslam/core/npy.h"
#include "hqslam/core/whole_file.h"
#include "side_by_side/side_by_side.h"
#include "terminal/progress.h"
#include "train/drive_recall.h"

namespace hqslam::tools {
namespace {

namespace fs = std::filesystem;

/// Raised whenever the recall of the same drive changes.
constexpr int kMemoryRevision = 2;

/// Everything that determines the bytes of a stored drive.
std::string key_of(const StoredDrive& drive) {
  const sim::DriveSpec& spec = drive.spec;
  nlohmann::ordered_json key;
  key["revision"] = sim::kDriveRevision;
  key["name"] = spec.name;
  key["seed"] = spec.seed;
  key["scans"] = spec.scans;
  key["every"] = drive.every;
  key["mount"] = {spec.mount.sensor_height_m, spec.mount.mount_roll_rad,
                  spec.mount.mount_pitch_rad};
  key["conditions"] = {spec.conditions.extra_range_noise_m, spec.conditions.dropout_share,
                       spec.conditions.extinction_per_m, spec.conditions.airborne_share};
  if (spec.sensor_errors != sim::SensorErrors::kNone) {
    key["sensor_errors"] = sim::name_of(spec.sensor_errors);
  }
  key["sensor"] = sensor_json(drive.sensor);
  if (drive.recalled_rows) {
    key["memory"] = {kMemoryRevision, drive.recalled_rows->offset, drive.recalled_rows->stride};
    if (drive.look_ahead) key["memory"].push_back("look ahead");
  }
  return key.dump();
}

bool is_stored(const std::string& path, const StoredDrive& drive) {
  if (!fs::is_regular_file(path)) return false;
  try {
    return NpyStackReader(path).images() == drive.scans();
  } catch (const Error&) {
    return false;  // damaged: made again
  }
}

/// Simulates a drive with recall. Of scans that are not stored only the recalled rows are
/// simulated.
bool simulate_with_memory(const StoredDrive& drive, NpyStackWriter& writer,
                          const std::function<bool()>& stopping, Progress& progress) {
  const RowSelection rows = *drive.recalled_rows;
  sim::DriveSimulator simulator(drive.spec, drive.sensor);
  DriveRecall recall(drive.sensor, rows, drive.look_ahead, drive.spec.seed);
  const auto write_finished = [&](bool is_last) {
    while (const auto image = recall.finished(is_last)) {
      writer.append(*image);
      progress.advance();
    }
  };
  for (std::int64_t i = 0; i < drive.spec.scans; ++i) {
    if (stopping()) return false;
    const bool kept = i % drive.every == 0;
    const auto scan = simulator.next(kept ? std::nullopt : std::optional(rows));
    if (kept) recall.want(*scan);
    write_finished(false);
    recall.add(*scan);
  }
  write_finished(true);
  return true;
}

/// Returns false if it stopped before the end.
bool simulate(const StoredDrive& drive, const std::string& path,
              const std::function<bool()>& stopping, Progress& progress) {
  const SensorModel& sensor = drive.sensor;
  if (drive.recalled_rows) {
    NpyStackWriter writer(path, 3 * sensor.rows(), sensor.columns);
    return simulate_with_memory(drive, writer, stopping, progress);
  }
  sim::DriveSimulator simulator(drive.spec, sensor);
  NpyStackWriter writer(path, sensor.rows(), sensor.columns);
  while (const auto scan = simulator.next()) {
    if (stopping()) return false;
    writer.append(scan->image);
    simulator.skip(drive.every - 1);
    progress.advance();
  }
  return true;
}

/// Simulates a drive into a file that gets its name when it is complete. Two programs may simulate
/// the same drive at once. Returns false if it stopped before the end.
bool store_drive(const StoredDrive& drive, const std::string& path,
                 const std::function<bool()>& stopping, Progress& progress) {
  const std::string part = fmt::format("{}.{}.part", path, getpid());
  const RemovedAtEnd part_removed(part);  // unless it was renamed
  const bool whole = simulate(drive, part, stopping, progress);
  if (whole) rename_file(part, path);
  return whole;
}

/// Returns false if it stopped before the end.
bool store_all(const DriveStore& store, const std::vector<StoredDrive>& drives, const char* label,
               const InterruptGuard& interrupt) {
  make_result_folder(store.path);
  std::int64_t scans = 0;
  for (const StoredDrive& drive : drives) scans += drive.scans();
  Progress progress(label, scans);
  const int workers = std::clamp(store.threads, 1, static_cast<int>(drives.size()));
  const bool whole =
      side_by_side(drives.size(), workers, std::max(1, store.threads / workers),
                   [&](std::size_t i, const std::atomic<bool>& stopped) {
                     return store_drive(
                         drives[i], path_in_store(store.path, drives[i]),
                         [&] { return stopped || interrupt.stop_requested(); }, progress);
                   });
  progress.finish();
  return whole;
}

}  // namespace

std::string path_in_store(const fs::path& folder, const StoredDrive& drive) {
  return (folder /
          fmt::format("{}_{}_{}.npy", drive.spec.name, drive.spec.seed, text_hash(key_of(drive))))
      .string();
}

bool store_drives(const DriveStore& store, const std::vector<StoredDrive>& drives,
                  const char* label, const InterruptGuard& interrupt) {
  std::vector<StoredDrive> missing;
  std::set<std::string> named;  // a drive may be in a recipe twice, to be shown more often
  for (const StoredDrive& drive : drives) {
    sim::validate(drive.spec);
    const std::string path = path_in_store(store.path, drive);
    const bool is_first = named.insert(path).second;
    if (is_first && !is_stored(path, drive)) missing.push_back(drive);
  }
  return missing.empty() || store_all(store, missing, label, interrupt);
}

}  // namespace hqslam::tools

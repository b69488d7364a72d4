#include "laboratory/train/training_scans.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <random>
#include <regex>

#include "files/content_hash.h"
#include "files/result_files.h"
#include "hqslam/core/error.h"
#include "hqslam/core/npy.h"
#include "hqslam/core/projection.h"
#include "hqslam/core/scan_source.h"
#include "hqslam/core/whole_file.h"
#include "hqslam/nn/scan_memory.h"
#include "ranks/ranks.h"
#include "recording/reading.h"
#include "terminal/progress.h"
#include "terminal/terminal.h"

namespace hqslam::tools {
namespace {

namespace fs = std::filesystem;

/// Raised whenever the same drive begins to recall something else.
constexpr int kMemoryRevision = 1;

/// Everything that decides the bytes of a stored drive.
std::string key_of(const StoredDrive& drive, const SensorModel& sensor) {
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
  key["sensor"] = sensor_json(sensor);
  if (drive.remembered_rows) {
    key["memory"] = {kMemoryRevision, drive.remembered_rows->offset, drive.remembered_rows->stride};
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

void rename_to(const std::string& from, const std::string& to) {
  std::error_code failure;
  fs::rename(from, to, failure);
  if (failure) {
    throw Error("{}: cannot be written ({}); check that the folder is writable", to,
                failure.message());
  }
}

/// A file of which nothing stays unless it was renamed.
struct RemovedAtEnd {
  const fs::path path;
  ~RemovedAtEnd() {
    std::error_code ignored;
    fs::remove(path, ignored);
  }
};

/// What store() writes on the way to a name of path_in_store.
bool is_part(const std::string& name) {
  static const std::regex part(R"(.+_\d+_[0-9a-f]+\.npy\.\d+\.part)");
  return std::regex_match(name, part);
}

/// Of programs that were killed: nobody has a lock on them.
void remove_abandoned_parts(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> abandoned;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const fs::path& path = entry->path();
    if (!is_part(path.filename().string())) continue;
    if (FileLock(path).state() == FileLock::State::kHeld) abandoned.push_back(path);
  }
  for (const fs::path& path : abandoned) fs::remove(path, error);
}

/// How far SLAM's poses are off, standard deviations on each axis: of each scan that is remembered,
/// and of the one that recalls, which may be registered or only predicted: a tenth to all of it.
/// Measured on `town` and `hills` with 16 rows and typical beam errors: registered over ten scans
/// 4 to 12 mm and 0.02 degrees, predicted 12 to 17 mm and 0.03 to 0.06 degrees on each axis.
constexpr double kKeptError_m = 0.003;
constexpr double kKeptError_rad = 0.0002;
constexpr double kPredictedError_m = 0.02;
constexpr double kPredictedError_rad = 0.0012;
constexpr double kLeastOfPredicted = 0.1;

/// The poses of a scan as SLAM may have them: all off by one and the same small motion.
nn::ColumnPoses with_error(const nn::ColumnPoses& poses, double error_m, double error_rad,
                           std::mt19937_64& random) {
  const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  const auto off = [&](double sigma) {  // the sum of twelve uniform numbers is nearly normal
    double sum = -6.0;
    for (int i = 0; i < 12; ++i) sum += uniform();
    return sigma * sum;
  };
  Twist error;
  for (int axis = 0; axis < 3; ++axis) {
    error.linear[axis] = off(error_m);
    error.angular[axis] = off(error_rad);
  }
  const Pose T_right_off = exponential(error);
  nn::ColumnPoses result;
  for (const Pose& pose : poses) result.push_back(pose * T_right_off);
  return result;
}

/// The measured rows of a drive's scans one after the other, and what each recalls of those before.
class Recollection {
 public:
  Recollection(const SensorModel& sensor, RowSelection rows, std::uint64_t seed)
      : sensor_(select_rows(sensor, rows)), memory_(measured_by(sensor, rows)), random_(seed) {}

  /// The image of a scan with M and W^2 below it.
  RangeImage with_recalled(RangeImage image, const RangeImage& measured,
                           const nn::ColumnPoses& poses) {
    const double how_far =
        std::pow(kLeastOfPredicted, static_cast<double>(random_() >> 11) * 0x1p-53);
    const nn::RecalledImage recalled = memory_.recall(
        measured,
        with_error(poses, how_far * kPredictedError_m, how_far * kPredictedError_rad, random_));
    const std::size_t pixels = image.range_m.size();
    if (!recalled.is_empty()) {
      image.range_m.insert(image.range_m.end(), recalled.image.range_m.begin(),
                           recalled.image.range_m.end());
      image.range_m.insert(image.range_m.end(), recalled.weight.begin(), recalled.weight.end());
    }
    image.range_m.resize(3 * pixels);
    image.rows *= 3;
    return image;
  }
  void remember(const RangeImage& measured, const nn::ColumnPoses& poses, double stamp_s) {
    memory_.insert(unproject(measured, sensor_, CaptureTime::kRolling),
                   with_error(poses, kKeptError_m, kKeptError_rad, random_), stamp_s);
  }

 private:
  static SensorModel measured_by(SensorModel sensor, RowSelection rows) {
    sensor.measured_rows = rows;
    return sensor;
  }

  SensorModel sensor_;
  nn::ScanMemory memory_;
  std::mt19937_64 random_;
};

/// simulate() of a drive whose scans recall earlier ones: of those between only the rows that are
/// remembered are simulated.
bool simulate_with_memory(const StoredDrive& drive, const SensorModel& sensor,
                          NpyStackWriter& writer, const std::function<bool()>& stopping,
                          Progress& progress) {
  const RowSelection rows = *drive.remembered_rows;
  sim::DriveSimulator simulator(drive.spec, sensor);
  Recollection recollection(sensor, rows, drive.spec.seed);
  for (std::int64_t i = 0; i < drive.spec.scans; ++i) {
    if (stopping()) return false;
    const bool kept = i % drive.every == 0;
    const auto scan = simulator.next(kept ? std::nullopt : std::optional(rows));
    const RangeImage measured = select_rows(scan->image, rows);
    if (kept) {
      writer.append(
          recollection.with_recalled(scan->image, measured, scan->T_map_sensor_at_column));
      progress.advance();
    }
    recollection.remember(measured, scan->T_map_sensor_at_column, scan->stamp_s);
  }
  return true;
}

/// Returns false if it stopped before the end.
bool simulate(const StoredDrive& drive, const SensorModel& sensor, const std::string& path,
              const std::function<bool()>& stopping, Progress& progress) {
  if (drive.remembered_rows) {
    NpyStackWriter writer(path, 3 * sensor.rows(), sensor.columns);
    return simulate_with_memory(drive, sensor, writer, stopping, progress);
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

/// The same, under its name once it is whole. Two programs may be at the same drive.
bool store(const StoredDrive& drive, const SensorModel& sensor, const std::string& path,
           const std::function<bool()>& stopping, Progress& progress) {
  const std::string part = fmt::format("{}.{}.part", path, getpid());
  const RemovedAtEnd part_removed{part};
  std::ofstream(part).close();
  const FileLock lock(part);
  const bool whole = simulate(drive, sensor, part, stopping, progress);
  if (whole) rename_to(part, path);
  return whole;
}

bool store_all(const std::vector<StoredDrive>& drives, const fs::path& folder,
               const SensorModel& sensor, int threads, const char* label,
               const InterruptGuard& interrupt) {
  std::int64_t scans = 0;
  for (const StoredDrive& drive : drives) scans += drive.scans();
  Progress progress(label, scans);
  const int workers = std::clamp(threads, 1, static_cast<int>(drives.size()));
  const bool whole =
      side_by_side(drives.size(), workers, std::max(1, threads / workers),
                   [&](std::size_t i, const std::atomic<bool>& stopped) {
                     return store(
                         drives[i], sensor, path_in_store(folder, drives[i], sensor),
                         [&] { return stopped || interrupt.stop_requested(); }, progress);
                   });
  progress.finish();
  return whole;
}

}  // namespace

std::string path_in_store(const fs::path& folder, const StoredDrive& drive,
                          const SensorModel& sensor) {
  return (folder / fmt::format("{}_{}_{}.npy", drive.spec.name, drive.spec.seed,
                               text_hash(key_of(drive, sensor))))
      .string();
}

bool store_drives(const fs::path& folder, const std::vector<StoredDrive>& drives,
                  const SensorModel& sensor, int threads, const char* label,
                  const InterruptGuard& interrupt, Ranks& ranks) {
  ranks.rank_0_first([&] {
    if (ranks.rank() == 0) remove_abandoned_parts(folder);  // while nobody writes any
  });
  // By place among all: what is missing changes while others are at work.
  std::vector<StoredDrive> missing;
  for (std::size_t i = 0; i < drives.size(); ++i) {
    sim::validate(drives[i].spec);
    const bool own =
        i % static_cast<std::size_t>(ranks.count()) == static_cast<std::size_t>(ranks.rank());
    if (own && !is_stored(path_in_store(folder, drives[i], sensor), drives[i])) {
      missing.push_back(drives[i]);
    }
  }
  bool stopped = false;
  if (!missing.empty()) {
    make_result_folder(folder);
    stopped = !store_all(missing, folder, sensor, threads, label, interrupt);
  }
  return !ranks.any(stopped);
}

namespace {

/// "$NAME/rest" with the environment variable's value.
std::string expanded(const std::string& path) {
  if (!path.starts_with("$")) return path;
  const std::size_t slash = std::min(path.find('/'), path.size());
  const std::string name = path.substr(1, slash - 1);
  const char* value = std::getenv(name.c_str());
  if (value == nullptr) {
    throw Error("{}: the environment variable {} is not set", path, name);
  }
  return value + path.substr(slash);
}

/// A recording's folder as a stack in the store, written once: a name made of its path and files,
/// and of the sensor.
std::string stack_of_recording(const std::string& folder, const SensorModel& sensor,
                               const DriveStore& store) {
  const std::string about =
      std::filesystem::absolute(folder).string() + folder_hash(folder) + sensor_json(sensor);
  const std::filesystem::path path = store.path / fmt::format("recording_{}.npy", text_hash(about));
  if (std::filesystem::exists(path)) return path.string();
  make_result_folder(store.path);
  replace_file(path.string(), [&](const std::string& part) {
    const auto source = open_recording(folder, sensor);
    NpyStackWriter writer(part, sensor.rows(), sensor.columns);
    LeftOut left_out;
    while (const auto scan = next_usable(*source, left_out)) {
      writer.append(range_image(scan->cloud));
    }
    if (left_out.scans > 0) to_stderr("hqslam: {}: {}\n", folder, left_out.text());
  });
  return path.string();
}

std::vector<StoredDrive> drives_of(const nn::ScanSet& set, const nn::NetworkDescription& network) {
  std::vector<StoredDrive> drives;
  for (const nn::SimulatedScans& simulated : set.simulated) {
    for (const int seed : simulated.seeds) {
      sim::DriveSpec spec = sim::drive_preset(simulated.drive);
      spec.seed = static_cast<std::uint64_t>(seed);
      spec.scans = simulated.scans;
      spec.sensor_errors = sim::sensor_errors_named(simulated.sensor_errors);
      if (simulated.conditions == nn::DriveConditions::kVaried) {
        spec = sim::with_varied_conditions(spec);
      }
      drives.push_back({spec, simulated.every});
      if (has_scan_memory(network)) drives.back().remembered_rows = network.measured_rows;
    }
  }
  return drives;
}

/// Throws Error if none of five images from all over a stack has a return that the sensor can have
/// had: millimetres, an empty file, no ranges at all.
void require_returns(const std::string& path, const SensorModel& sensor) {
  constexpr std::int64_t kTried = 5;
  NpyStackReader reader(path);
  const std::int64_t last = reader.images() - 1;
  for (std::int64_t k = 0; k < kTried && last >= 0; ++k) {
    const RangeImage image = reader.read(last * k / (kTried - 1));
    const bool any = std::any_of(image.range_m.begin(), image.range_m.end(), [&](float r) {
      return r >= sensor.min_range_m && r > 0.0F && r <= sensor.max_range_m;
    });
    if (any) return;
  }
  throw Error(
      "{}: expected images with ranges from {} to {} m (sensor '{}'), found none; give ranges in "
      "metres",
      path, sensor.min_range_m, sensor.max_range_m, sensor.name);
}

}  // namespace

StoredScans::StoredScans(const std::vector<std::string>& paths, const SensorModel& sensor)
    : rows_(sensor.rows()), columns_(sensor.columns) {
  for (const std::string& path : paths) {
    const NpyStackReader reader(path);
    const bool fits = reader.rows() == rows_ || reader.rows() == 3 * rows_;
    if (!fits || reader.columns() != columns_) {
      throw Error("{}: images of {} x {}, expected the {} x {} of {}", path, reader.rows(),
                  reader.columns(), rows_, columns_, sensor.name);
    }
    require_returns(path, sensor);
    const std::int64_t begin = size();
    files_.push_back({path, begin, begin + reader.images()});
  }
}

nn::TrainingScan StoredScans::read(std::int64_t i) const {
  if (i < 0 || i >= size()) {
    throw Error("training: scan {}, expected 0 to {}", i, size() - 1);
  }
  const auto file = std::upper_bound(files_.begin(), files_.end(), i,
                                     [](std::int64_t scan, const File& f) { return scan < f.end; });
  RangeImage image = NpyStackReader(file->path).read(i - file->begin);
  const bool recalls = image.rows == 3 * rows_;
  if ((image.rows != rows_ && !recalls) || image.columns != columns_) {
    throw Error("{}: changed while it was read", file->path);
  }
  for (float& range_m : image.range_m) {
    if (!std::isfinite(range_m) || range_m < 0.0F) range_m = 0.0F;
  }
  if (!recalls) return {std::move(image)};
  const auto part = [&](int k) {
    RangeImage result(rows_, columns_);
    std::copy_n(image.range_m.begin() + k * std::ssize(result.range_m), result.range_m.size(),
                result.range_m.begin());
    return result;
  };
  return {part(0), {part(1), part(2).range_m}};
}

std::unique_ptr<const StoredScans> stored_scans(const nn::ScanSet& set,
                                                const nn::NetworkDescription& network,
                                                const DriveStore& store, const char* label,
                                                const InterruptGuard& interrupt) {
  const SensorModel& sensor = network.sensor;
  std::vector<std::string> paths;
  store.ranks.rank_0_first([&] {
    for (const std::string& stack : set.stacks) {
      const std::string path = expanded(stack);
      paths.push_back(std::filesystem::is_directory(path) ? stack_of_recording(path, sensor, store)
                                                          : path);
    }
  });
  // What is wrong with a stack should be said before hours of simulation.
  static_cast<void>(StoredScans(paths, sensor));
  const std::vector<StoredDrive> drives = drives_of(set, network);
  if (!store_drives(store.path, drives, sensor, store.threads, label, interrupt, store.ranks)) {
    return nullptr;
  }
  for (const StoredDrive& drive : drives) paths.push_back(path_in_store(store.path, drive, sensor));
  return std::make_unique<const StoredScans>(paths, sensor);
}

}  // namespace hqslam::tools

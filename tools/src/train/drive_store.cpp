#include "train/drive_store.h"

#include <fmt/format.h>
#include <omp.h>
#include <unistd.h>

#include <atomic>
#include <exception>
#include <fstream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "files/content_hash.h"
#include "files/result_folder.h"
#include "hqslam/core/error.h"
#include "hqslam/core/npy.h"
#include "terminal/progress.h"

namespace hqslam::tools {
namespace {

namespace fs = std::filesystem;

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
  key["sensor"] = sensor_json(sensor);
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
    throw Error(fmt::format("{}: cannot be written ({}); check that the folder is writable", to,
                            failure.message()));
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

/// Of programs that were killed: nobody has a lock on them.
void remove_abandoned_parts(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> abandoned;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const fs::path& path = entry->path();
    if (path.extension() != ".part") continue;
    if (FileLock(path).state() == FileLock::State::kHeld) abandoned.push_back(path);
  }
  for (const fs::path& path : abandoned) fs::remove(path, error);
}

/// Threads that take one drive after the other.
class Crew {
 public:
  Crew(std::vector<StoredDrive> drives, const fs::path& folder, const SensorModel& sensor,
       const char* label, const InterruptGuard& interrupt)
      : drives_(std::move(drives)),
        folder_(folder),
        sensor_(sensor),
        interrupt_(interrupt),
        progress_(label, total_scans()) {}

  bool work(int threads) {
    const int drives = static_cast<int>(drives_.size());
    const int crew = std::clamp(threads, 1, drives);
    std::vector<std::thread> others;
    for (int k = 1; k < crew; ++k) others.emplace_back([&] { take_drives(threads / crew); });
    // Not on this thread: how many threads OpenMP starts inside a drive is set for each thread.
    others.emplace_back([&] { take_drives(threads / crew); });
    for (std::thread& other : others) other.join();
    if (thrown_ != nullptr) std::rethrow_exception(thrown_);
    progress_.finish();
    return !interrupt_.stop_requested();
  }

 private:
  std::int64_t total_scans() const {
    std::int64_t total = 0;
    for (const StoredDrive& drive : drives_) total += drive.scans();
    return total;
  }

  bool stopping() const { return failed_ || interrupt_.stop_requested(); }

  void take_drives(int threads_inside) {
    omp_set_num_threads(std::max(1, threads_inside));
    try {
      for (std::size_t k = next_++; k < drives_.size() && !stopping(); k = next_++) {
        store(drives_[k]);
      }
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (thrown_ == nullptr) thrown_ = std::current_exception();
      failed_ = true;
    }
  }

  void store(const StoredDrive& drive) {
    const std::string path = path_in_store(folder_, drive, sensor_);
    // Two programs may be at the same drive.
    const std::string part = fmt::format("{}.{}.part", path, getpid());
    const RemovedAtEnd part_removed{part};
    std::ofstream(part).close();
    const FileLock lock(part);
    if (simulate(drive, part)) rename_to(part, path);
  }

  /// Returns false if it stopped before the end.
  bool simulate(const StoredDrive& drive, const std::string& path) {
    sim::DriveSimulator simulator(drive.spec, sensor_);
    NpyStackWriter writer(path, sensor_.rows(), sensor_.columns);
    while (const auto scan = simulator.next()) {
      if (stopping()) return false;
      writer.append(scan->image);
      simulator.skip(drive.every - 1);
      const std::lock_guard lock(mutex_);
      progress_.update(++scans_done_);
    }
    return true;
  }

  const std::vector<StoredDrive> drives_;
  const fs::path& folder_;
  const SensorModel& sensor_;
  const InterruptGuard& interrupt_;
  std::atomic<std::size_t> next_ = 0;
  std::atomic<bool> failed_ = false;
  std::mutex mutex_;  ///< of the three below
  Progress progress_;
  std::int64_t scans_done_ = 0;
  std::exception_ptr thrown_;
};

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
    stopped = !Crew(std::move(missing), folder, sensor, label, interrupt).work(threads);
  }
  return !ranks.any(stopped);
}

}  // namespace hqslam::tools

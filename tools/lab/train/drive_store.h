#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "hqslam/core/sensor_model.h"
#include "hqslam/nn/training/ranks.h"
#include "hqslam/sim/drive.h"
#include "terminal/terminal.h"

namespace hqslam::tools {

/// Scans 0, every, 2 every, ... of a simulated drive.
struct StoredDrive {
  sim::DriveSpec spec;
  std::int64_t every = 1;
  /// The rows whose earlier measurements each scan recalls (nn::ScanMemory); nothing: none are.
  std::optional<RowSelection> remembered_rows = std::nullopt;
  bool look_ahead = false;  ///< and the later ones (nn::kLookAheadScans)

  std::int64_t scans() const { return (spec.scans + every - 1) / every; }
};

/// Where a folder of drives keeps this one: an .npy stack of its range images, with what is
/// recalled below each (M, then W^2, rows x columns each), named by drive and seed and by a hash of
/// everything that decides its bytes.
std::string path_in_store(const std::filesystem::path& folder, const StoredDrive& drive,
                          const SensorModel& sensor);

/// Where simulated drives are kept, and by whom and by how many threads of each they are made.
struct DriveStore {
  std::filesystem::path path;
  int threads;
  Ranks& ranks;
};

/// Simulates the drives that are not in the folder yet, each rank its share of them, as many drives
/// at a time as the store has threads; returns when all are done. A file appears under its name
/// when it is whole, so that whatever stops the program, the next call goes on with the drives that
/// are missing; several programs may share a folder. Shows progress on stderr. Returns false if it
/// was asked to stop before it was done. Throws Error.
bool store_drives(const DriveStore& store, const std::vector<StoredDrive>& drives,
                  const SensorModel& sensor, const char* label, const InterruptGuard& interrupt);

}  // namespace hqslam::tools

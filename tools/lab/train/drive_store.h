#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "hqslam/core/sensor_model.h"
#include "hqslam/sim/drive.h"
#include "terminal/terminal.h"

namespace hqslam::tools {

/// Scans 0, every, 2 every, ... of a simulated drive.
struct StoredDrive {
  sim::DriveSpec spec;
  SensorModel sensor;
  std::int64_t every = 1;
  /// Rows whose points in other scans each scan recalls (nn::ScanMemory); nothing: no recall.
  std::optional<RowSelection> recalled_rows = std::nullopt;
  bool look_ahead = false;  ///< recall of later scans too (nn::kLookAheadScans)

  std::int64_t scans() const { return (spec.scans + every - 1) / every; }
};

/// Path of a drive in a folder of drives: an .npy stack of its range images, with the recall below
/// each (M, then W^2, rows x columns each), named by drive and seed and by a hash of everything
/// that determines its bytes.
std::string path_in_store(const std::filesystem::path& folder, const StoredDrive& drive);

/// The folder of simulated drives and the number of threads that fill it.
struct DriveStore {
  std::filesystem::path path;
  int threads;
};

/// Simulates the drives that are not in the folder yet, as many at a time as the store has threads.
/// A file gets its name when it is complete, so a later call continues with the missing drives;
/// several programs may share a folder. Shows progress on stderr. Returns false if it was
/// interrupted. Throws Error.
bool store_drives(const DriveStore& store, const std::vector<StoredDrive>& drives,
                  const char* label, const InterruptGuard& interrupt);

}  // namespace hqslam::tools

#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hqslam/core/range_image.h"
#include "hqslam/core/ranks.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/nn/training/trainer.h"
#include "hqslam/nn/training/training_configuration.h"
#include "hqslam/sim/drive.h"
#include "terminal/terminal.h"

namespace hqslam::tools {

/// Scans 0, every, 2 every, ... of a simulated drive.
struct StoredDrive {
  sim::DriveSpec spec;
  std::int64_t every = 1;
  /// The rows whose earlier measurements each scan recalls (nn::ScanMemory); nothing: none are.
  std::optional<RowSelection> remembered_rows = std::nullopt;

  std::int64_t scans() const { return (spec.scans + every - 1) / every; }
};

/// Where a folder of drives keeps this one: an .npy stack of its range images, with what is
/// recalled below each (M, then W^2, rows x columns each), named by drive and seed and by a hash of
/// everything that decides its bytes.
std::string path_in_store(const std::filesystem::path& folder, const StoredDrive& drive,
                          const SensorModel& sensor);

/// Simulates the drives that are not in the folder yet, each rank its share of them, `threads`
/// drives at a time; returns when all are done. A file appears under its name when it is whole, so
/// that whatever stops the program, the next call goes on with the drives that are missing; several
/// programs may share a folder. Shows progress on stderr. Returns false if it was asked to stop
/// before it was done. Throws Error.
bool store_drives(const std::filesystem::path& folder, const std::vector<StoredDrive>& drives,
                  const SensorModel& sensor, int threads, const char* label,
                  const InterruptGuard& interrupt, Ranks& ranks);

/// The scans of .npy stacks, read one by one from their files; what is no range (NaN, infinite,
/// negative) is no return. Images of three times the sensor's rows have what is recalled.
class StoredScans final : public nn::TrainingScans {
 public:
  /// Throws Error if a file cannot be read or has images of another shape than the sensor's.
  StoredScans(const std::vector<std::string>& paths, const SensorModel& sensor);
  std::int64_t size() const override { return files_.empty() ? 0 : files_.back().end; }
  int rows() const override { return rows_; }
  int columns() const override { return columns_; }
  nn::TrainingScan read(std::int64_t i) const override;

 private:
  struct File {
    std::string path;
    std::int64_t begin = 0;  ///< the first scan of the file among all
    std::int64_t end = 0;
  };
  std::vector<File> files_;
  int rows_;
  int columns_;
};

/// Where simulated drives are kept, and by whom and by how many threads of each they are made.
struct DriveStore {
  std::filesystem::path path;
  int threads;
  Ranks& ranks;
};

/// All scans of a set in its order, stacks first, then drives; those that are not in the folder
/// yet are simulated. Shows progress on stderr; null if asked to stop meanwhile. Throws Error, also
/// for a stack of another shape than the sensor's.
std::unique_ptr<const StoredScans> stored_scans(const nn::ScanSet& set,
                                                const nn::NetworkDescription& network,
                                                const DriveStore& store, const char* label,
                                                const InterruptGuard& interrupt);

}  // namespace hqslam::tools

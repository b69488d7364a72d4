#pragma once

#include <memory>
#include <string>
#include <vector>

#include "hqslam/nn/training/trainer.h"
#include "hqslam/nn/training/training_configuration.h"
#include "train/drive_store.h"

namespace hqslam::tools {

/// The scans of .npy stacks, read one by one from their files. Values that are no ranges (NaN,
/// infinite, negative) become no return. Images with three times the sensor's rows have recall.
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

/// All scans of a set in its order, stacks first, then drives, which are simulated if they are not
/// in the folder yet. Shows progress on stderr. Returns null if interrupted. Throws Error, also for
/// a stack of another shape than the sensor's.
std::unique_ptr<const StoredScans> stored_scans(const nn::ScanSet& set,
                                                const nn::NetworkDescription& network,
                                                const DriveStore& store, const char* label,
                                                const InterruptGuard& interrupt);

}  // namespace hqslam::tools

#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hqslam/nn/training/trainer.h"
#include "hqslam/nn/training/training_configuration.h"
#include "train/drive_store.h"

namespace hqslam::tools {

/// An .npy stack of scans.
struct ScanStack {
  std::string path;
  std::optional<nn::ScanSensor> sensor = {};  ///< nothing: that of the training
};

/// The scans of .npy stacks, read one by one from their files. Values that are no ranges (NaN,
/// infinite, negative) become no return. Images with three times the sensor's rows have recall.
class StoredScans final : public nn::TrainingScans {
 public:
  /// sensor: of stacks without one. Throws Error if a file cannot be read or has images of another
  /// shape than its sensor's.
  StoredScans(const std::vector<ScanStack>& stacks, const SensorModel& sensor);
  std::int64_t size() const override { return files_.empty() ? 0 : files_.back().end; }
  nn::TrainingScan read(std::int64_t i) const override;

 private:
  struct File {
    ScanStack stack;
    int rows = 0;
    int columns = 0;
    std::int64_t begin = 0;  ///< the first scan of the file among all
    std::int64_t end = 0;
  };
  std::vector<File> files_;
};

/// All scans of a set of the configuration in its order, stacks first, then drives, which are
/// simulated if they are not in the folder yet. Shows progress on stderr. Returns null if
/// interrupted. Throws Error, also for a stack of another shape than its sensor's.
std::unique_ptr<const StoredScans> stored_scans(const nn::ScanSet& set,
                                                const nn::TrainingConfiguration& configuration,
                                                const DriveStore& store, const char* label,
                                                const InterruptGuard& interrupt);

}  // namespace hqslam::tools

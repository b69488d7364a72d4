#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hqslam/nn/network_description.h"
#include "hqslam/nn/training/trainer.h"

namespace hqslam::nn {

/// One point of the learning curve.
struct CurvePoint {
  std::int64_t step = 0;
  double loss = 0.0;  ///< mean over the steps since the last point
  Validation validation;
};

/// A training that can go on exactly where it stopped.
struct Checkpoint {
  std::string configuration;  ///< the training configuration's text
  TrainingState state;
  std::vector<CurvePoint> curve;
  double loss_sum = 0.0;  ///< over the steps since the last point of the curve
};

/// An .npz file. Throws Error.
void write_checkpoint(const std::string& path, const Checkpoint& checkpoint);
/// Throws Error with file, field, expected, found; also if the checkpoint is of another
/// configuration.
Checkpoint read_checkpoint(const std::string& path, const std::string& configuration,
                           const NetworkDescription& description, const AdamWOptions& adamw);

}  // namespace hqslam::nn

#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "hqslam/core/range_image.h"
#include "hqslam/nn/network_description.h"
#include "hqslam/nn/training/adamw.h"
#include "hqslam/nn/training/augmentation.h"

namespace hqslam::nn {

/// The training of a network: everything but the scans that decides the result.
struct TrainingPlan {
  std::int64_t steps = 10'000;
  int batch = 4;  ///< samples whose gradients are summed before a step
  float learning_rate = 1e-3F;
  std::int64_t warm_up_steps = 100;
  AdamWOptions adamw;
  /// Share in the loss of each layer before the last: with 0 only the last Z has to be an image,
  /// and the others are of no use to the filter inside or to a reader.
  float layer_loss_share = 0.1F;
  double largest_gradient_norm =
      0.1;                            ///< of the loss in the network's own unit (L1: range_scale_m)
  std::int64_t average_steps = 1000;  ///< of the mean of the parameters that is kept
  Augmentation augmentation;
  /// For a network that fits any sensor: the sensor of the scans, with many rows, of which each
  /// sample gets some (draw_beams). Nothing: the scans are the network's sensor's.
  std::optional<SensorModel> drawn_from = std::nullopt;
  std::uint64_t seed = 1;
};
/// Throws Error with field, value and constraint.
void validate(const TrainingPlan& plan, const SensorModel& sensor);

/// The scans that a network is trained on: ranges in metres, 0 where nothing returned, never NaN,
/// infinite or negative.
class TrainingScans {
 public:
  virtual ~TrainingScans() = default;
  virtual std::int64_t size() const = 0;
  /// Scan i, 0 to size() - 1. Many threads may read at once. Throws Error if it cannot be read.
  virtual TrainingScan read(std::int64_t i) const = 0;
};

struct TrainingStep {
  double loss = 0.0;           ///< of the last layer, mean over the batch, before the step
  double gradient_norm = 0.0;  ///< before it was clipped
  float learning_rate = 0.0F;
};

/// How an upsampled image differs from the truth, over the computed pixels of all scans.
struct ImageFigures {
  double mae_all_m = 0.0;    ///< over all pixels, measured ones too; no return counts as 0 m
  double mae_valid_m = 0.0;  ///< over the pixels where both have a return, measured ones too
  double wrong_share = 0.0;  ///< of the computed returns: farther than 0.5 m from the pixel's true
                             ///< range, or where there is none
  double missing_share = 0.0;  ///< of the true returns: left empty
};

/// How well the network does on scans that it is not trained on.
struct Validation {
  ImageFigures network;
  ImageFigures linear;  ///< linear interpolation over rows
  /// DU-Mix: the confidence below which pixels were emptied for these figures, so that as many
  /// true returns are missing as linear interpolation misses.
  double least_confidence = 0.0;
  /// DU-Mix: the power of the confidence with the smallest Brier score; least_confidence is before
  /// it.
  double confidence_exponent = 1.0;
};

/// Everything that a training needs to go on as if it had not stopped.
struct TrainingState {
  std::vector<float> parameters;
  AdamW optimiser;
  /// Exponential mean of the parameters over the last steps (about average_steps of the plan): what
  /// is validated and kept.
  std::vector<float> average;
};

/// Trains on scans with all of the sensor's rows. Each step draws its samples from seed, step and
/// place in the batch alone, and sums gradients in that order: the result depends neither on the
/// number of threads nor on interruptions.
class Trainer {
 public:
  /// Throws Error, also if the first scan does not have its sensor's shape or the state not the
  /// network's number of parameters.
  Trainer(const NetworkDescription& description, const TrainingPlan& plan,
          std::unique_ptr<const TrainingScans> scans, TrainingState state, int threads);
  ~Trainer();

  /// Throws Error if a scan cannot be read or does not have its sensor's shape, or if the loss is
  /// not finite.
  TrainingStep step();
  /// Throws Error if a scan does not have the sensor's shape.
  Validation validate(const std::vector<TrainingScan>& scans);
  const TrainingState& state() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace hqslam::nn

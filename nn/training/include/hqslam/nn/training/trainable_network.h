#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "hqslam/core/range_image.h"
#include "hqslam/nn/instruction_set.h"
#include "hqslam/nn/network_description.h"
#include "hqslam/nn/upsampled_image.h"

namespace hqslam::nn {

/// What the network gets and what it should give.
struct TrainingSample {
  RangeImage measured;          ///< the measured rows only
  RangeImage truth;             ///< all rows
  RecalledImage recalled = {};  ///< all rows, or empty
};

struct LossOptions {
  /// Share of each layer before the last: with 0 only the last layer's Z has to be an image.
  float layer_share = 0.1F;
};

/// A network that is trained: forward with all that its gradients need, and back. Not thread-safe:
/// one object per thread.
class TrainableNetwork {
 public:
  virtual ~TrainableNetwork() = default;

  /// All arrays of parameter_shapes(description), one after the other. Throws Error for another
  /// number of values.
  virtual void set_parameters(std::span<const float> parameters) = 0;

  /// The training losses of the scans of a batch, in units of the network's own, summed; their
  /// gradients are added to d_parameters. seeds: one for each scan, for what is random. Samples
  /// have the network's shapes. One thread, also inside a parallel region of the caller's.
  double add_gradients(std::span<const TrainingSample> batch, const LossOptions& options,
                       std::span<const std::uint64_t> seeds, std::span<float> d_parameters);

 private:
  /// add_gradients by a team of one thread.
  virtual double batch_gradients(std::span<const TrainingSample> batch, const LossOptions& options,
                                 std::span<const std::uint64_t> seeds,
                                 std::span<float> d_parameters) = 0;
};

/// `columns` may be fewer than the sensor's: cut-outs for training. Throws Error as make_network,
/// and if the network's kind cannot be trained.
std::unique_ptr<TrainableNetwork> make_trainable(const NetworkDescription& description, int columns,
                                                 InstructionSet instruction_set);

}  // namespace hqslam::nn

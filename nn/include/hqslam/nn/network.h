#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "hqslam/core/range_image.h"
#include "hqslam/nn/instruction_set.h"
#include "hqslam/nn/lifted_image.h"
#include "hqslam/nn/network_description.h"
#include "hqslam/nn/network_step.h"
#include "hqslam/nn/trace.h"
#include "hqslam/nn/training_sample.h"

namespace hqslam::nn {

/// What the loss looks at.
struct LossOptions {
  /// Share of each layer before the last: with 0 only the last one has to say what is there.
  float layer_share = 0.1F;
};

/// A network with its weights packed for one image size, and memory for one scan at a time: what
/// lifts scans, and what is trained. Not thread-safe: one object per thread (team).
class Network {
 public:
  virtual ~Network() = default;

  /// Multiply-adds of the convolutions for one scan.
  virtual std::int64_t multiply_adds() const = 0;
  /// All arrays of parameter_shapes(description), one after the other. Throws Error for another
  /// number of values.
  virtual void set_parameters(std::span<const float> parameters) = 0;

  /// measured: the measured rows, metres; 0 = no return, never negative or not finite, which
  /// SuperResolver sees to. Returns what the network says of every computed pixel, nothing emptied
  /// for want of confidence; a range outside the sensor's limits is no return. `confidence` is for
  /// a tolerance of tolerance_m. Throws Error for another shape.
  virtual const LiftedImage& lift(const RangeImage& measured, float tolerance_m) = 0;

  /// What it says of every pixel before anything is emptied or put back, metres: the self-test of a
  /// weights file.
  virtual RangeImage estimate(const RangeImage& measured) { return lift(measured, 0.5F).image; }

  /// What every layer makes of a scan; `rejected` of the whole is left empty. Throws Error for
  /// another shape.
  virtual Trace trace(const RangeImage& measured) = 0;

  /// The training loss of one scan, in units of the network's own; its gradient is added to
  /// d_parameters. truth: all rows, metres, 0 = no return. One thread.
  virtual double add_gradient(const RangeImage& measured, const RangeImage& truth,
                              const LossOptions& options, std::uint64_t seed,
                              std::span<float> d_parameters) = 0;

  /// Whether the scans of a batch see each other (batch norm): add_gradients then gets all of them
  /// in one call.
  virtual bool joins_batch() const { return false; }
  /// The sum over the scans of a batch, a seed each.
  virtual double add_gradients(std::span<const TrainingSample> batch, const LossOptions& options,
                               std::span<const std::uint64_t> seeds, std::span<float> d_parameters);

  /// Lifts a scan and says of what parts that took so much time, in their order; `measured` and the
  /// network must outlive them. Empty: nobody has measured them yet.
  virtual std::vector<NetworkStep> steps(const RangeImage& /*measured*/) { return {}; }
};

/// `columns` may be fewer than the sensor's: cut-outs for training. Throws Error if the description
/// is invalid, the network cannot have that many columns or the processor has not the instructions.
std::unique_ptr<Network> make_network(const NetworkDescription& description, int columns,
                                      InstructionSet instruction_set, int threads);

}  // namespace hqslam::nn

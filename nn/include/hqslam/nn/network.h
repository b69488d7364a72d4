#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "hqslam/core/range_image.h"
#include "hqslam/nn/instruction_set.h"
#include "hqslam/nn/network_description.h"
#include "hqslam/nn/upsampled_image.h"

namespace hqslam::nn {

class Trace;

/// What a network knows of a scan; refers to its parts.
struct Observation {
  /// Without memory. Implicit: this is what most networks see.
  Observation(const RangeImage& measured_) : measured(measured_) {}  // NOLINT(*-explicit-*)
  Observation(const RangeImage& measured_, const RecalledImage& recalled_)
      : measured(measured_), recalled(&recalled_) {}

  const RangeImage& measured;  ///< the measured rows, metres; 0 = no return, never anything else
  const RecalledImage* recalled = nullptr;  ///< null, or empty: nothing; of networks without memory
};

/// What the network sees and what it should say.
struct TrainingSample {
  RangeImage measured;          ///< the measured rows only
  RangeImage truth;             ///< all rows
  RecalledImage recalled = {};  ///< all rows, or empty
};

/// What the loss looks at.
struct LossOptions {
  /// Share of each layer before the last: with 0 only the last one has to say what is there.
  float layer_share = 0.1F;
};

/// A part of a network that can be run by itself, to be measured.
struct NetworkStep {
  std::string name;                ///< "encoder.0"
  int calls = 1;                   ///< for one scan
  std::int64_t multiply_adds = 0;  ///< of one call
  /// On what the last scan left, as often as one likes.
  std::function<void()> run;
  bool by_team = true;  ///< called by all threads of a parallel region, which share the work
  /// The same, written as its formula, by one thread; empty if there is no such thing.
  std::function<void()> reference = {};
};

/// A network with its weights packed for one image size, and memory for one scan at a time: what
/// upsamples scans, and what is trained. Not thread-safe: one object per thread (team).
class Network {
 public:
  virtual ~Network() = default;

  /// Multiply-adds of the convolutions for one scan.
  virtual std::int64_t multiply_adds() const = 0;
  /// All arrays of parameter_shapes(description), one after the other. Throws Error for another
  /// number of values.
  virtual void set_parameters(std::span<const float> parameters) = 0;

  /// No range is negative or not finite, which SuperResolver sees to. Returns what the network says
  /// of every computed pixel, nothing emptied for want of confidence; a range outside the sensor's
  /// limits is no return. `confidence` is for a tolerance of tolerance_m. Throws Error for another
  /// shape.
  virtual const UpsampledImage& upsample(const Observation& seen, float tolerance_m) = 0;

  /// What it says of every pixel before anything is emptied or put back, metres: the self-test of a
  /// weights file.
  virtual RangeImage estimate(const RangeImage& measured) { return upsample(measured, 0.5F).image; }

  /// Every inner tensor by name. Throws Error for another shape.
  virtual Trace trace(const Observation& seen) = 0;

  /// The training losses of the scans of a batch, in units of the network's own, summed; their
  /// gradients are added to d_parameters. seeds: of what is random, one for each scan. One thread,
  /// also inside a parallel region of the caller's. Throws Error for other shapes or numbers.
  double add_gradients(std::span<const TrainingSample> batch, const LossOptions& options,
                       std::span<const std::uint64_t> seeds, std::span<float> d_parameters);

  /// Upsamples a scan and says of what parts that took so much time, in their order; `measured` and
  /// the network must outlive them. Empty: nobody has measured them yet.
  virtual std::vector<NetworkStep> steps(const RangeImage& /*measured*/) { return {}; }

 protected:
  /// For images of `columns` columns.
  Network(const NetworkDescription& description, int columns);
  /// Throws Error unless the measured rows, and what is recalled, have their shapes.
  void check(const Observation& seen) const;

 private:
  /// add_gradients of what has been checked, by a team of one thread.
  virtual double batch_gradients(std::span<const TrainingSample> batch, const LossOptions& options,
                                 std::span<const std::uint64_t> seeds,
                                 std::span<float> d_parameters) = 0;

  int measured_rows_;
  int rows_;
  int columns_;
  std::int64_t parameters_;
};

/// `columns` may be fewer than the sensor's: cut-outs for training. Throws Error if the description
/// is invalid, the network cannot have that many columns, the processor has not the instructions,
/// or threads is not 1 to 1024.
std::unique_ptr<Network> make_network(const NetworkDescription& description, int columns,
                                      InstructionSet instruction_set, int threads);

}  // namespace hqslam::nn

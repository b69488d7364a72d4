#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "hqslam/core/range_image.h"
#include "hqslam/nn/instruction_set.h"
#include "hqslam/nn/network_description.h"
#include "hqslam/nn/upsampled_image.h"

namespace hqslam::nn {

class Trace;

/// The input of a network, by reference.
struct Observation {
  /// Without memory. Implicit: most networks take no more.
  Observation(const RangeImage& measured_) : measured(measured_) {}  // NOLINT(*-explicit-*)
  Observation(const RangeImage& measured_, const RecalledImage& recalled_)
      : measured(measured_), recalled(&recalled_) {}

  const RangeImage& measured;  ///< the measured rows, metres; 0 = no return, never anything else
  const RecalledImage* recalled = nullptr;  ///< null or empty: nothing is recalled
};

/// A network with its weights packed for one image size, and memory for one scan at a time. Scans
/// have that size: SuperResolver checks it. Not thread-safe: one object per thread (team).
class Network {
 public:
  virtual ~Network() = default;

  /// Multiply-adds of the convolutions for one scan.
  virtual std::int64_t multiply_adds() const = 0;
  /// All arrays of parameter_shapes(description), one after the other. Throws Error for another
  /// number of values.
  virtual void set_parameters(std::span<const float> parameters) = 0;

  /// No range of the scan is negative or not finite. Returns the network's range of every computed
  /// pixel, whatever its confidence; a range outside the sensor's limits is no return.
  /// tolerance_m: the range tolerance to which the confidence refers.
  virtual const UpsampledImage& upsample(const Observation& seen, float tolerance_m) = 0;

  /// The network's range of every pixel before any is emptied or restored, metres: the self-test of
  /// a weights file.
  virtual RangeImage estimate(const RangeImage& measured) { return upsample(measured, 0.5F).image; }

  /// Every inner tensor by name.
  virtual Trace trace(const Observation& seen) = 0;
};

/// description: valid (`validate`), as network_from_json returns it. `columns` may be fewer than
/// the sensor's. Throws Error if the network cannot have that number of columns, the processor or
/// the build lacks the instruction set, or threads is not 1 to 1024.
std::unique_ptr<Network> make_network(const NetworkDescription& description, int columns,
                                      InstructionSet instruction_set, int threads);

}  // namespace hqslam::nn

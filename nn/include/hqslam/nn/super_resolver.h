#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "hqslam/core/range_image.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/nn/instruction_set.h"
#include "hqslam/nn/network_description.h"
#include "hqslam/nn/upsampled_image.h"
#include "hqslam/nn/weights_file.h"

namespace hqslam::nn {

class Trace;

struct SuperResolverOptions {
  int threads = 0;            ///< 0: as many as OpenMP would use
  bool filter_result = true;  ///< the weights file's filter at the end, if it has one
  /// How near to the truth a range must be to count as right in the confidence.
  float tolerance_m = 0.5F;
  /// Computed pixels with a smaller confidence come out empty; nothing: the weights file's. Throws
  /// Error unless 0 to 1. Networks without a confidence ignore both.
  std::optional<float> least_confidence = std::nullopt;
  std::optional<InstructionSet> instruction_set =
      std::nullopt;  ///< nothing: chosen_instruction_set(); Error where it is not available
};

/// Upsamples the scans of a sensor with few rows to many.
///
/// Threads: one object serves one thread at a time; objects are independent of one another. Each
/// works with options.threads OpenMP threads, or, inside a parallel region of the caller's, with
/// the one that calls it. The result is the same whatever their number.
class SuperResolver {
 public:
  /// Reads and checks a weights file and runs its self-test. Throws Error.
  static SuperResolver load(const std::string& path, const SuperResolverOptions& options = {});
  SuperResolver(const Weights& weights, const SuperResolverOptions& options);
  ~SuperResolver();
  SuperResolver(SuperResolver&&) noexcept;  ///< moved from: only assign or destroy
  SuperResolver& operator=(SuperResolver&&) noexcept;

  const NetworkDescription& description() const;
  /// The sensor of the result.
  const SensorModel& sensor() const { return description().sensor; }
  std::int64_t parameters() const;
  std::int64_t multiply_adds() const;

  /// image: the measured rows alone, or all rows, of which the measured ones are looked at; metres;
  /// what is not above 0, not finite or beyond the sensor's max_range_m is no return. Returns all
  /// rows: measured rows as they were; rejected and doubtful pixels and those outside the sensor's
  /// limits empty. Throws Error for any other shape. With `trace` it also writes down every layer.
  UpsampledImage run(const RangeImage& image, Trace* trace = nullptr) {
    return run(image, {}, trace);
  }
  /// The same with what earlier scans tell (ScanMemory::recall), all rows; networks without a
  /// memory do not look at it. Throws Error for another shape.
  UpsampledImage run(const RangeImage& image, const RecalledImage& recalled,
                     Trace* trace = nullptr);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace hqslam::nn

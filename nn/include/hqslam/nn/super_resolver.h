#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "hqslam/core/range_image.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/nn/architectures.h"
#include "hqslam/nn/instruction_set.h"
#include "hqslam/nn/network_description.h"
#include "hqslam/nn/upsampled_image.h"
#include "hqslam/nn/weights_file.h"

namespace hqslam::nn {

class Trace;

struct SuperResolverOptions {
  int threads = 0;            ///< 0: as many as OpenMP would use
  bool filter_result = true;  ///< the weights file's filter at the end, if it has one
  /// Range tolerance in metres to which the confidence refers.
  float tolerance_m = 0.5F;
  /// Computed pixels with a smaller confidence come out empty; nothing: the weights file's value.
  /// Throws Error unless 0 to 1. Networks without a confidence ignore it and the tolerance.
  std::optional<float> least_confidence = std::nullopt;
  std::optional<InstructionSet> instruction_set =
      std::nullopt;  ///< nothing: chosen_instruction_set(); Error where it is not available
  Architectures architectures = hqs_architectures();  ///< the kinds of networks that `load` reads
};

/// Upsamples the scans of a sensor with few rows to many.
///
/// Threads: one object serves one thread at a time; objects are independent of one another. Each
/// works with options.threads OpenMP threads, or, inside a parallel region of the caller's, with
/// the thread that calls it. Any number of threads gives the same result.
class SuperResolver {
 public:
  /// Reads and checks a weights file and runs its self-test. Throws Error.
  static SuperResolver load(const std::string& path, const SuperResolverOptions& options = {});
  /// The network of weights that were read from `path`, after its self-test. Throws Error.
  static SuperResolver checked(const Weights& weights, const std::string& path,
                               const SuperResolverOptions& options = {});
  /// Without the self-test.
  SuperResolver(const Weights& weights, const SuperResolverOptions& options);
  ~SuperResolver();
  SuperResolver(SuperResolver&&) noexcept;  ///< moved from: only assign or destroy
  SuperResolver& operator=(SuperResolver&&) noexcept;

  /// The same network for another sensor (nn::for_sensor). Throws Error.
  SuperResolver for_sensor(const SensorModel& sensor, RowSelection measured_rows) const;

  const NetworkDescription& description() const;
  /// The sensor of the result.
  const SensorModel& sensor() const { return description().sensor; }
  std::int64_t parameters() const;
  std::int64_t multiply_adds() const;

  /// image: the measured rows alone, or all rows, of which the measured ones are used; metres. A
  /// range that is not above 0, not finite or beyond the sensor's max_range_m is no return. Returns
  /// all rows: measured rows as they were; rejected pixels, those below least_confidence and those
  /// outside the sensor's limits empty. Throws Error for any other shape. trace: gets every layer.
  UpsampledImage run(const RangeImage& image, Trace* trace = nullptr) {
    return run(image, {}, trace);
  }
  /// Upsamples with what is recalled of earlier scans too (ScanMemory::recall), all rows; networks
  /// without a memory ignore it. Throws Error for another shape.
  UpsampledImage run(const RangeImage& image, const RecalledImage& recalled,
                     Trace* trace = nullptr);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace hqslam::nn

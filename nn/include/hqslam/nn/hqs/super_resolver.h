#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hqslam/core/range_image.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/nn/hqs/network_description.h"
#include "hqslam/nn/hqs/weights_file.h"
#include "hqslam/nn/instruction_set.h"

namespace hqslam::nn {

/// The terms of eq. 3 after one layer, in m^2 over all pixels (mu J has no value: it is learned).
struct ObjectiveTerms {
  double data_m2 = 0.0;          ///< 1/2 |L - D H|^2
  double denoiser_gap_m2 = 0.0;  ///< b/2 |Z - H|^2
  double filter_gap_m2 = 0.0;    ///< b/2 |Y - H|^2; Simple DU has no such term
  std::int64_t rejected = 0;     ///< pixels that Q rejects
};

/// What one layer computed, for people who want to look.
struct LayerTrace {
  RangeImage h;                        ///< metres, after data consistency (eq. 10a)
  RangeImage z;                        ///< after the denoiser (eq. 10b)
  RangeImage y;                        ///< after outlier removal (eq. 10c); Simple DU: Z
  std::vector<std::uint8_t> rejected;  ///< Q's mask, one per pixel; Simple DU: all 0
  float penalty = 0.0F;                ///< b
  ObjectiveTerms objective;
};

struct Trace {
  RangeImage start;  ///< Z0 = Y0
  std::vector<LayerTrace> layers;
  std::vector<std::uint8_t> rejected;  ///< by the filter at the end
};

struct SuperResolverOptions {
  int threads = 0;  ///< 0: as many as OpenMP would use
  /// Instead of the weights file's; min_pixels 0 switches the filter off everywhere.
  std::optional<OutlierRemovalOptions> filter = std::nullopt;
  bool filter_result = true;  ///< Q on the last layer's Z
  std::optional<InstructionSet> instruction_set =
      std::nullopt;  ///< nothing: chosen_instruction_set()
};

/// Lifts the scans of a sensor with few rows to many. Not thread-safe: one object per thread.
class SuperResolver {
 public:
  /// Reads and checks a weights file and runs its self-test. Throws Error.
  static SuperResolver load(const std::string& path, const SuperResolverOptions& options = {});
  SuperResolver(const Weights& weights, const SuperResolverOptions& options);
  ~SuperResolver();
  SuperResolver(SuperResolver&&) noexcept;
  SuperResolver& operator=(SuperResolver&&) noexcept;

  const NetworkDescription& description() const;
  /// The sensor of the result.
  const SensorModel& sensor() const { return description().sensor; }
  std::int64_t parameters() const;
  std::int64_t multiply_adds() const;

  /// image: the measured rows alone, or all rows, of which the measured ones are looked at; metres.
  /// Returns all rows: measured rows as they were, rejected pixels and pixels outside the sensor's
  /// limits empty. Throws Error for any other shape. With `trace` it also writes down every layer.
  RangeImage run(const RangeImage& image, Trace* trace = nullptr);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace hqslam::nn

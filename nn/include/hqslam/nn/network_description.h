#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hqslam/core/sensor_model.h"
#include "hqslam/nn/hqs/outlier_removal.h"

namespace hqslam::nn {

/// One array of learned parameters, in PyTorch's layout.
struct ParameterShape {
  std::string name;  ///< "encoder.0.weight"
  std::vector<std::int64_t> shape;
  /// The array follows the network's data (batch norm) and is not learned; its gradient is its
  /// distance to them.
  bool statistic = false;
  std::int64_t elements() const;
};

/// The number of values of all arrays together.
std::int64_t elements(const std::vector<ParameterShape>& shapes);

/// The kind of network, with everything that only this kind has. Immutable; made by
/// network_from_json, and used by the functions below.
class Architecture;

/// Everything about a network but its parameters.
struct NetworkDescription {
  std::shared_ptr<const Architecture> architecture;
  SensorModel sensor;  ///< with all rows
  RowSelection measured_rows;
  float range_scale_m = 80.0F;  ///< ranges are divided by it
  /// For networks with a confidence: computed pixels with a smaller one come out empty. Chosen
  /// after training, so that as many true returns are missing as linear interpolation misses.
  float least_confidence = 0.1F;
  /// The network's probability to this power is the confidence. Fitted after training on scans that
  /// were not trained on, so that the confidence is the share of pixels that are right.
  float confidence_exponent = 1.0F;
};

/// "du-or", "simple-du", "du-mix", ...
std::string_view name(const NetworkDescription& description);

/// Whether the same parameters serve every sensor (for_sensor).
bool fits_any_sensor(const NetworkDescription& description);
/// The network for images of another sensor, with the same parameters. sensor: with all rows.
/// Throws Error for a network that is made for one sensor, and as validate().
NetworkDescription for_sensor(const NetworkDescription& description, const SensorModel& sensor,
                              RowSelection measured_rows);

/// The network's images have a multiple of this number of columns.
int column_multiple(const NetworkDescription& description);

/// Whether the network gives a confidence for each pixel.
bool has_confidence(const NetworkDescription& description);

/// Whether the network uses what earlier scans measured (ScanMemory).
bool has_scan_memory(const NetworkDescription& description);

/// The outlier filter that the result goes through at the end; nothing: none.
std::optional<OutlierRemovalOptions> last_filter(const NetworkDescription& description);

/// Throws Error with field, value and constraint.
void validate(const NetworkDescription& description);

/// The arrays of the whole network: "layers.0.encoder.0.weight", ...
std::vector<ParameterShape> parameter_shapes(const NetworkDescription& description);

/// Starting values for training, the same on every machine.
std::vector<float> initial_parameters(const NetworkDescription& description, std::uint64_t seed);

}  // namespace hqslam::nn

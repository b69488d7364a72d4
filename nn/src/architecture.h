#pragma once

#include <cstdint>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string_view>
#include <vector>

#include "hqslam/core/json_fields.h"
#include "hqslam/nn/network.h"
#include "hqslam/nn/network_description.h"

namespace hqslam::nn {

/// A kind of network with its sizes: everything about it that NetworkDescription does not have, in
/// one place. Immutable, and never of senseless sizes: making one throws Error with field, value
/// and constraint. Each kind is a class of its own and a line of a table (architectures.h).
class Architecture {
 public:
  virtual ~Architecture() = default;

  /// As in the table.
  virtual std::string_view name() const = 0;
  /// Adds the fields that the kind's `read` takes to those that every network has.
  virtual void write(nlohmann::ordered_json& network) const = 0;
  /// Throws Error unless it fits the sensor and the measured rows, and memory.
  virtual void validate(const NetworkDescription& description) const = 0;
  /// The number of columns of an image is a multiple of this.
  virtual int column_multiple() const = 0;

  /// In the order in which Network::set_parameters takes them.
  virtual std::vector<ParameterShape> parameter_shapes(
      const NetworkDescription& description) const = 0;
  virtual std::vector<float> initial_parameters(const NetworkDescription& description,
                                                std::uint64_t seed) const = 0;
  /// For images of `columns` columns, a multiple of column_multiple().
  virtual std::unique_ptr<Network> make_network(const NetworkDescription& description, int columns,
                                                InstructionSet instruction_set,
                                                int threads) const = 0;

  /// The same network for images with other rows; null if it is made for one sensor.
  virtual std::shared_ptr<const Architecture> for_rows(RowSelection /*measured_rows*/) const {
    return nullptr;
  }

  /// Whether Network::upsample gives a confidence.
  virtual bool has_confidence() const { return false; }
  /// Whether the network uses what earlier scans measured (Observation::recalled).
  virtual bool has_scan_memory() const { return false; }
  /// The outlier filter that the result goes through at the end.
  virtual std::optional<OutlierRemovalOptions> last_filter() const { return std::nullopt; }
};

/// The sensor in a field: a preset's name, or the contents of a sensor file. Throws Error.
SensorModel read_sensor_field(const char* field, const std::string& source, JsonFields& fields);

/// Throws Error unless this processor and this build have the instruction set.
void require_available(InstructionSet instruction_set);

/// Throws Error unless it is 0 to 1.
void check_least_confidence(const NetworkDescription& description);

/// Throws Error unless the network's images can have this number of columns.
void check_columns(const NetworkDescription& description, int columns);

/// Throws Error if tensors with this number of values in all, which training and a trace ask for,
/// are more than any network should take.
void check_memory(std::int64_t values, const NetworkDescription& description);

}  // namespace hqslam::nn

#pragma once

#include <cstdint>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "hqslam/core/json_fields.h"
#include "hqslam/nn/network.h"
#include "hqslam/nn/network_description.h"

namespace hqslam::nn {

/// A kind of network with its sizes: all that is to be known of it beyond NetworkDescription, in
/// one place. Immutable, and never of senseless sizes: whoever makes one throws Error with field,
/// value and constraint. Each kind is a class of its own and a line in architectures.cpp.
class Architecture {
 public:
  virtual ~Architecture() = default;

  /// As in the registry.
  virtual std::string_view name() const = 0;
  /// Adds the fields that the kind's `read` takes to those that every network has.
  virtual void write(nlohmann::ordered_json& network) const = 0;
  /// Throws Error unless it fits the sensor and the measured rows, and memory.
  virtual void validate(const NetworkDescription& description) const = 0;
  /// Images have a multiple of so many columns.
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

  /// Whether Network::upsample says how sure it is.
  virtual bool has_confidence() const { return false; }
  /// Whether it looks at what earlier scans measured (Observation::recalled).
  virtual bool has_scan_memory() const { return false; }
  /// The outlier filter that the result goes through at the end.
  virtual std::optional<OutlierRemovalOptions> last_filter() const { return std::nullopt; }
};

struct NamedArchitecture {
  const char* name;  ///< "kind" in JSON
  /// Takes what only this kind has out of a network's fields. Throws Error.
  std::shared_ptr<const Architecture> (*read)(JsonFields& network);
};
/// All there are: those of architectures.cpp, and what was added.
std::span<const NamedArchitecture> architectures();
/// Of another component; before any network is read. Added again it stays one.
void add_architecture(const NamedArchitecture& added);

/// Throws Error unless its images can have so many columns.
void check_columns(const NetworkDescription& description, int columns);

/// Throws Error if tensors with so many values in all, which training and a trace ask for, are
/// more than any network should take.
void check_memory(std::int64_t values, const NetworkDescription& description);

}  // namespace hqslam::nn

#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "../architecture.h"
#include "two_modes_graph.h"

namespace hqslam::nn {

/// "du-mix": layers that say two modes and the probability of a return (two_modes_network.h).
class DuMix final : public Architecture {
 public:
  /// last_filter: of the result; none by default. Throws Error with field, value and constraint.
  explicit DuMix(TwoModesShape shape,
                 const std::optional<OutlierRemovalOptions>& last_filter = std::nullopt);

  std::string_view name() const override { return "du-mix"; }
  void write(nlohmann::ordered_json& network) const override;
  void validate(const NetworkDescription& description) const override;
  int column_multiple() const override { return 2 * shape_.tile.columns; }
  /// "layers.0.encoder.0.weight", ...
  std::vector<ParameterShape> parameter_shapes(
      const NetworkDescription& description) const override;
  std::vector<float> initial_parameters(const NetworkDescription& description,
                                        std::uint64_t seed) const override;
  std::unique_ptr<Network> make_network(const NetworkDescription& description, int columns,
                                        InstructionSet instruction_set, int threads) const override;
  bool has_confidence() const override { return true; }
  std::optional<OutlierRemovalOptions> last_filter() const override { return last_filter_; }

 private:
  LayerGraph smallest_graph(const NetworkDescription& description, int layer) const;

  TwoModesShape shape_;
  std::optional<OutlierRemovalOptions> last_filter_;
};

std::shared_ptr<const Architecture> read_du_mix(JsonFields& network);

}  // namespace hqslam::nn

#pragma once

#include <memory>

#include "architecture.h"
#include "tulip_graph.h"

namespace hqslam::nn {

/// "tulip": a transformer (tulip_graph.h).
class Tulip final : public Architecture {
 public:
  /// Throws Error with field, value and constraint.
  explicit Tulip(TulipShape shape);

  std::string_view name() const override { return "tulip"; }
  void write(nlohmann::ordered_json& network) const override;
  void validate(const NetworkDescription& description) const override;
  int column_multiple() const override;
  std::vector<ParameterShape> parameter_shapes(
      const NetworkDescription& description) const override;
  std::vector<float> initial_parameters(const NetworkDescription& description,
                                        std::uint64_t seed) const override;
  std::unique_ptr<Network> make_network(const NetworkDescription& description, int columns,
                                        InstructionSet instruction_set, int threads) const override;

 private:
  TulipShape shape_;
};

std::shared_ptr<const Architecture> read_tulip(JsonFields& network);

}  // namespace hqslam::nn

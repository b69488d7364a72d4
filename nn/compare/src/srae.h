#pragma once

#include <memory>

#include "architecture.h"
#include "srae_graph.h"

namespace hqslam::nn {

/// "srae": a U-Net with Monte Carlo dropout (srae_graph.h).
class Srae final : public Architecture {
 public:
  /// Throws Error with field, value and constraint.
  explicit Srae(const SraeShape& shape);

  std::string_view name() const override { return "srae"; }
  void write(nlohmann::ordered_json& network) const override;
  void validate(const NetworkDescription& description) const override;
  int column_multiple() const override { return kSraeStride; }
  std::vector<ParameterShape> parameter_shapes(
      const NetworkDescription& description) const override;
  std::vector<float> initial_parameters(const NetworkDescription& description,
                                        std::uint64_t seed) const override;
  std::unique_ptr<Network> make_network(const NetworkDescription& description, int columns,
                                        InstructionSet instruction_set, int threads) const override;

 private:
  LayerGraph training_graph(const NetworkDescription& description, int columns) const;

  SraeShape shape_;
};

std::shared_ptr<const Architecture> read_srae(JsonFields& network);

}  // namespace hqslam::nn

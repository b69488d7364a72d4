#pragma once

#include "direct_network.h"
#include "tulip_graph.h"

namespace hqslam::nn {

/// "tulip": a transformer (tulip_graph.h).
class Tulip final : public DirectArchitecture {
 public:
  /// Throws Error with field, value and constraint.
  explicit Tulip(TulipShape shape);

  std::string_view name() const override { return "tulip"; }
  void write(nlohmann::ordered_json& network) const override;
  void validate(const NetworkDescription& description) const override;
  int column_multiple() const override;
  LayerGraph graph(const NetworkDescription& description, int columns, Purpose purpose,
                   const Engine& engine) const override;
  DirectPlan plan() const override { return {.logarithmic = true}; }

 private:
  TulipShape shape_;
};

std::shared_ptr<const Architecture> read_tulip(JsonFields& network);

}  // namespace hqslam::nn

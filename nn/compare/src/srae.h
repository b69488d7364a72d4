#pragma once

#include "srae_graph.h"

namespace hqslam::nn {

/// "srae": a U-Net with Monte Carlo dropout (srae_graph.h).
class Srae final : public DirectArchitecture {
 public:
  /// Throws Error with field, value and constraint.
  explicit Srae(const SraeShape& shape);

  std::string_view name() const override { return "srae"; }
  void write(nlohmann::ordered_json& network) const override;
  void validate(const NetworkDescription& description) const override;
  int column_multiple() const override { return kSraeStride; }
  LayerGraph graph(const NetworkDescription& description, int columns, Purpose purpose,
                   const Engine& engine) const override;
  DirectPlan plan() const override {
    return {.passes = shape_.passes, .largest_deviation = shape_.largest_deviation};
  }

 private:
  SraeShape shape_;
};

std::shared_ptr<const Architecture> read_srae(JsonFields& network);

}  // namespace hqslam::nn

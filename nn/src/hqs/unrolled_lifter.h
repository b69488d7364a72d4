#pragma once

#include <optional>
#include <vector>

#include "hqslam/nn/network.h"
#include "unrolled_network.h"

namespace hqslam::nn {

/// The unrolled loop as what lifts scans and is trained: their image is the last Z, their loss is
/// L1. They do not say how sure they are.
class UnrolledLifter final : public Network {
 public:
  UnrolledLifter(const NetworkDescription& description, int columns, InstructionSet instruction_set,
                 int threads);

  std::int64_t multiply_adds() const override { return network_.multiply_adds(); }
  void set_parameters(std::span<const float> parameters) override;
  const LiftedImage& lift(const RangeImage& measured, float tolerance_m) override;
  RangeImage estimate(const RangeImage& measured) override;
  Trace trace(const RangeImage& measured) override;
  std::vector<NetworkStep> steps(const RangeImage& measured) override;
  double add_gradient(const RangeImage& measured, const RangeImage& truth,
                      const LossOptions& options, std::uint64_t seed,
                      std::span<float> d_parameters) override;

 private:
  /// What training needs: the values of all layers, and their gradients.
  struct Training {
    UnrolledState state;
    Tensor truth;
    std::vector<Tensor> d_z;  ///< of each layer
  };

  RangeImage in_metres(const Tensor& tiles) const;
  LayerTrace layer_trace(const UnrolledState& all, int layer, const RangeImage& measured) const;

  UnrolledNetwork network_;
  int threads_;
  UnrolledState state_;
  LiftedImage lifted_;
  std::optional<Training> training_;  ///< made when first needed
};

}  // namespace hqslam::nn

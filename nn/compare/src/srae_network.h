#pragma once

#include <vector>

#include "graph/layer_graph.h"
#include "hqslam/nn/network.h"
#include "srae.h"

namespace hqslam::nn {

/// SRAE works with ranges / range_scale_m; no return is 0.
float scaled_range(float range_m, float range_scale_m);
/// Called by all threads of a parallel region.
void take_scaled(const RangeImage& image, float range_scale_m, Tensor& tensor);

/// SRAE with its passes.
class SraeNetwork final : public Network {
 public:
  /// architecture: the description's.
  SraeNetwork(const Srae& architecture, const NetworkDescription& description, int columns,
              const Engine& engine);

  std::int64_t multiply_adds() const override;  ///< of all passes
  void set_parameters(std::span<const float> parameters) override {
    graph_.set_parameters(parameters);
  }
  const UpsampledImage& upsample(const Observation& seen, float tolerance_m) override;
  RangeImage estimate(const RangeImage& measured) override;
  Trace trace(const Observation& seen) override;

 private:
  /// Called by all threads of a parallel region.
  void add_pass(bool first);
  void run_passes(const RangeImage& measured, int passes);
  /// The mean of the passes, and whether they agree.
  float mean(std::size_t pixel) const;
  bool agreed(std::size_t pixel) const;
  void restore(const RangeImage& measured, RangeImage& image) const;

  NetworkDescription description_;
  SraeShape shape_;
  LayerGraph graph_;
  LayerGraph::Values values_;
  std::vector<double> sum_;      ///< over the passes, of every pixel
  std::vector<double> squares_;  ///< and of the squares
  UpsampledImage upsampled_;
};

}  // namespace hqslam::nn

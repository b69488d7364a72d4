#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "../layers/layer_graph.h"
#include "hqslam/nn/network.h"

namespace hqslam::nn {

/// How a network is used that goes from the measured rows to all rows in one go.
struct DirectPlan {
  std::function<LayerGraph()> graph_for_training;  ///< with the arrays of the one for lifting
  /// Images are ln(1 + range / range_scale_m), otherwise range / range_scale_m.
  bool logarithmic = false;
  int passes = 1;                  ///< with dropout, from 2 on
  float largest_deviation = 0.0F;  ///< of the passes, as a share of their mean
  /// Scans of a batch are normalised together (batch norm).
  bool joins_batch = false;
};

/// A network that says the range of every pixel at once, trained with the mean of the absolute
/// errors over all pixels, no return counting as 0.
class DirectNetwork final : public Network {
 public:
  /// graph: for lifting; one channel of measured rows in, one of all rows out.
  DirectNetwork(LayerGraph graph, DirectPlan plan, const NetworkDescription& description,
                int threads);

  std::int64_t multiply_adds() const override;  ///< of all passes
  void set_parameters(std::span<const float> parameters) override;
  const LiftedImage& lift(const RangeImage& measured, float tolerance_m) override;
  RangeImage estimate(const RangeImage& measured) override;
  Trace trace(const RangeImage& measured) override;
  std::vector<NetworkStep> steps(const RangeImage& measured) override;
  bool joins_batch() const override { return plan_.joins_batch; }
  double add_gradient(const RangeImage& measured, const RangeImage& truth,
                      const LossOptions& options, std::uint64_t seed,
                      std::span<float> d_parameters) override;
  double add_gradients(std::span<const TrainingSample> batch, const LossOptions& options,
                       std::span<const std::uint64_t> seeds,
                       std::span<float> d_parameters) override;

 private:
  struct Training {
    LayerGraph graph;
    std::vector<LayerGraph::Scan> scans;
    bool stale = true;  ///< the parameters have changed
  };

  void check(const RangeImage& measured) const;
  float to_unit(float range_m) const;
  float to_metres(float value) const;
  void take(const RangeImage& image, Tensor& tensor) const;
  /// Called by all threads of a parallel region.
  void add_pass(bool first);
  void run_passes(const RangeImage& measured);
  /// The mean of the passes, and whether they agree.
  float mean(std::size_t pixel) const;
  bool agreed(std::size_t pixel) const;
  void restore(const RangeImage& measured, RangeImage& image) const;

  LayerGraph graph_;
  DirectPlan plan_;
  NetworkDescription description_;
  int threads_;
  std::vector<Tensor> values_;
  std::vector<float> parameters_;
  std::vector<double> sum_;      ///< over the passes, of every pixel
  std::vector<double> squares_;  ///< and of the squares
  LiftedImage lifted_;
  std::optional<Training> training_;
};

}  // namespace hqslam::nn

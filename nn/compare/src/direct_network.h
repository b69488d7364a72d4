#pragma once

#include <vector>

#include "architecture.h"
#include "graph/layer_graph.h"
#include "hqslam/nn/network.h"
#include "trainable_architecture.h"

namespace hqslam::nn {

/// The use of a network that computes all rows from the measured ones at once.
struct DirectPlan {
  /// Images are ln(1 + range / range_scale_m), otherwise range / range_scale_m.
  bool logarithmic = false;
  int passes = 1;                  ///< with dropout, from 2 on
  float largest_deviation = 0.0F;  ///< of the passes, as a share of their mean
};

enum class Purpose { kUpsampling, kTraining };

/// A kind of such networks.
class DirectArchitecture : public Architecture, public TrainableArchitecture {
 public:
  /// One channel of measured rows in, one of all rows out. Graphs for upsampling need no gradients;
  /// the arrays are the same.
  virtual LayerGraph graph(const NetworkDescription& description, int columns, Purpose purpose,
                           const Engine& engine) const = 0;
  virtual DirectPlan plan() const = 0;

  std::vector<ParameterShape> parameter_shapes(const NetworkDescription& description) const final;
  std::vector<float> initial_parameters(const NetworkDescription& description,
                                        std::uint64_t seed) const final;
  std::unique_ptr<Network> make_network(const NetworkDescription& description, int columns,
                                        InstructionSet instruction_set, int threads) const final;
  std::unique_ptr<TrainableNetwork> make_trainable(const NetworkDescription& description,
                                                   int columns,
                                                   InstructionSet instruction_set) const final;
};

/// What a network of DirectPlan works with instead of metres.
struct DirectUnit {
  float range_scale_m = 1.0F;
  bool logarithmic = false;

  float of(float range_m) const;
  float to_metres(float value) const;
  /// Called by all threads of a parallel region.
  void take(const RangeImage& image, Tensor& tensor) const;
};

/// A network that gives the range of every pixel at once.
class DirectNetwork final : public Network {
 public:
  /// architecture: the description's.
  DirectNetwork(const DirectArchitecture& architecture, const NetworkDescription& description,
                int columns, const Engine& engine);

  std::int64_t multiply_adds() const override;  ///< of all passes
  void set_parameters(std::span<const float> parameters) override {
    graph_.set_parameters(parameters);
  }
  const UpsampledImage& upsample(const Observation& seen, float tolerance_m) override;
  RangeImage estimate(const RangeImage& measured) override;
  Trace trace(const Observation& seen) override;
  std::vector<NetworkStep> steps(const RangeImage& measured) override;

 private:
  /// Called by all threads of a parallel region.
  void add_pass(bool first);
  void run_passes(const RangeImage& measured, int passes);
  /// The mean of the passes, and whether they agree.
  float mean(std::size_t pixel) const;
  bool agreed(std::size_t pixel) const;
  void restore(const RangeImage& measured, RangeImage& image) const;

  NetworkDescription description_;
  DirectPlan plan_;
  DirectUnit unit_;
  LayerGraph graph_;
  LayerGraph::Values values_;
  std::vector<double> sum_;      ///< over the passes, of every pixel
  std::vector<double> squares_;  ///< and of the squares
  UpsampledImage upsampled_;
};

}  // namespace hqslam::nn

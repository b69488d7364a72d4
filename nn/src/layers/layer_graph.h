#pragma once

#include <memory>
#include <string>
#include <vector>

#include "hqslam/nn/network_step.h"
#include "layer.h"

namespace hqslam::nn {

/// Layers one after the other, each from tensors before it to one of its own. Described once:
/// parameters, multiply-adds, forward and backward follow. Tensor 0 is the input, the last one the
/// output.
class LayerGraph {
 public:
  explicit LayerGraph(const TensorShape& input) : shapes_{input} {}

  /// Returns the number of the layer's result. `name` stands before those of its arrays.
  int add(const std::string& name, std::unique_ptr<Layer> layer, std::vector<int> inputs);
  const TensorShape& shape(int tensor) const { return shapes_[tensor]; }
  const TensorShape& output_shape() const { return shapes_.back(); }

  std::vector<ParameterShape> parameter_shapes() const;
  std::vector<float> initial_parameters(std::uint64_t seed) const;
  /// From layer `first` on.
  std::int64_t multiply_adds(int first = 0) const;
  /// All arrays of parameter_shapes(), one after the other. Throws Error for another number.
  void set_parameters(std::span<const float> parameters);

  /// All zero.
  std::vector<Tensor> make_values() const;
  /// Fills the values from the layer number `first` on. Called by all threads of a parallel region,
  /// they share the work. seed: of all that is random; nothing: nothing is.
  void forward(std::vector<Tensor>& values, std::optional<std::uint64_t> seed = std::nullopt,
               int first = 0);
  /// The first layer whose result depends on the seed; as many as there are layers: none does.
  int first_random_layer() const;

  /// The layers, for measurements, those that depend on a seed and all behind them called `passes`
  /// times; graph and values must outlive them.
  std::vector<NetworkStep> steps(std::vector<Tensor>& values, int passes);

  /// One scan of a batch that is trained on.
  struct Scan {
    std::vector<Tensor> values;
    std::vector<Tensor> gradients;
    std::optional<std::uint64_t> seed;
  };
  /// From the first values to the last. One thread.
  void forward(std::span<Scan> batch);
  /// From the last gradients; d_parameters is added to. One thread.
  void backward(std::span<Scan> batch, std::span<float> d_parameters);

 private:
  struct Node {
    std::string name;
    std::unique_ptr<Layer> layer;
    std::vector<int> inputs;
    std::int64_t parameters = 0;
    std::uint64_t random_before = 0;  ///< layers before it that depend on a seed
  };
  LayerPass pass_of(int layer, std::vector<Tensor>& values,
                    std::optional<std::uint64_t> seed) const;
  std::vector<LayerPass> passes_of(int layer, std::span<Scan> batch) const;

  std::vector<TensorShape> shapes_;
  std::vector<Node> nodes_;  ///< node i makes tensor i + 1
};

}  // namespace hqslam::nn

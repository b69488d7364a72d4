#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "convolution_layer.h"

namespace hqslam::nn {

struct GraphForward {
  std::optional<std::uint64_t> seed = std::nullopt;  ///< with one the layers that have dropout drop
  int first = 0;     ///< the layers before it have been done already
  int left_out = 0;  ///< of the last layers
};
/// Layers one after the other, each from one or two tensors before it to one of its own. Described
/// once: parameters, multiply-adds and forward follow, and GraphBackward. Tensor 0 is the input,
/// the last one the output.
class LayerGraph {
 public:
  /// The tensors of one scan, or their gradients.
  using Values = std::vector<Tensor>;

  LayerGraph(const TensorShape& input, const Engine& engine) : engine_(engine), shapes_{input} {}

  /// Returns the number of the layer's result. `name` stands before those of its arrays. dropout:
  /// the share of its result that training drops. Throws Error if shapes do not fit.
  int add(const std::string& name, std::unique_ptr<Layer> layer, std::vector<int> inputs,
          float dropout = 0.0F);
  int add(const std::string& name, const ConvolutionOptions& options, std::vector<int> inputs,
          float dropout = 0.0F);
  const TensorShape& shape(int tensor) const { return shapes_[tensor]; }
  const TensorShape& output_shape() const { return shapes_.back(); }
  /// The name of the layer whose result tensor `tensor` is, from 1 on.
  const std::string& name_of(int tensor) const { return nodes_[tensor - 1].name; }
  const Engine& engine() const { return engine_; }

  std::vector<ParameterShape> parameter_shapes() const;
  std::vector<float> initial_parameters(std::uint64_t seed) const;
  /// The multiply-adds from layer `first` on.
  std::int64_t multiply_adds(int first = 0) const;
  /// All arrays of parameter_shapes(), one after the other. Throws Error for another number.
  void set_parameters(std::span<const float> parameters);

  /// All zero.
  Values make_values() const;
  /// How many values they hold.
  std::int64_t values() const;

  /// Called by all threads of a parallel region, which share the work.
  void forward(Values& values, const GraphForward& how = {});
  /// The first layer whose result depends on the seed; as many as there are layers: none does.
  int first_random_layer() const;
  /// One row of the last layer's result, a convolution's, by the calling thread alone.
  void last_row(const Values& values, int row, float* output, std::int64_t channel_stride) const;

  struct Node {
    std::string name;
    std::unique_ptr<Layer> layer;
    std::vector<int> inputs;
    float dropout = 0.0F;
    std::int64_t parameters = 0;
    std::uint64_t dropouts_before = 0;
  };
  /// For the backward pass: node i makes tensor i + 1.
  const std::vector<Node>& nodes() const { return nodes_; }
  LayerPass pass_of(int layer, Values& values) const;
  /// Drops out of a layer's result what the seed decides.
  void drop_out_of(int layer, std::uint64_t seed, Tensor& result) const;

 private:
  Engine engine_;
  std::vector<TensorShape> shapes_;
  std::vector<Node> nodes_;
  ConvolutionLayer* last_convolution_ = nullptr;  ///< if the last layer is one
};

/// What a dropout multiplies the values by that it keeps.
inline float kept_scale(float share) { return 1.0F / (1.0F - share); }

/// Each value is dropped with a probability of `share`, or else divided by 1 - share, so that the
/// mean stays; seed and place alone decide. Called by all threads of a parallel region, they share
/// the work; borders too.
void drop_out(std::uint64_t seed, float share, Tensor& values);

}  // namespace hqslam::nn

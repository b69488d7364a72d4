#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "convolution_layer.h"
#include "hqslam/nn/network.h"

namespace hqslam::nn {

struct GraphForward {
  std::optional<std::uint64_t> seed = std::nullopt;  ///< with one the layers that have dropout drop
  int first = 0;     ///< the layers before it have been done already
  int left_out = 0;  ///< of the last layers
};
struct GraphBackward {
  bool dropped = false;  ///< forward did, with a seed
  int left_out = 0;      ///< of the last layers, which have been done already
};

/// Layers one after the other, each from one or two tensors before it to one of its own. Described
/// once: parameters, multiply-adds, forward and backward follow. Tensor 0 is the input, the last
/// one the output.
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
  /// Of the layer whose result tensor `tensor` is, from 1 on.
  const std::string& name_of(int tensor) const { return nodes_[tensor - 1].name; }
  const Engine& engine() const { return engine_; }

  std::vector<ParameterShape> parameter_shapes() const;
  std::vector<float> initial_parameters(std::uint64_t seed) const;
  /// From layer `first` on.
  std::int64_t multiply_adds(int first = 0) const;
  /// All arrays of parameter_shapes(), one after the other. Throws Error for another number.
  void set_parameters(std::span<const float> parameters);

  /// All zero.
  Values make_values() const;
  /// How many values they hold.
  std::int64_t values() const;

  /// Called by all threads of a parallel region, they share the work.
  void forward(Values& values, const GraphForward& how = {});
  /// The first layer whose result depends on the seed; as many as there are layers: none does.
  int first_random_layer() const;
  /// One row of the last layer's result, a convolution's, by the calling thread alone.
  void last_row(const Values& values, int row, float* output, std::int64_t channel_stride) const;

  /// The scans of a batch that is trained on, from their first values to their last; a seed each.
  /// One thread.
  void forward_batch(std::span<Values> batch, std::span<const std::uint64_t> seeds);
  /// In: the gradients of the output. Out: those of the input; d_parameters is added to. The others
  /// are overwritten: the gradients of what went into their activations. One thread.
  void backward(std::span<const Values> batch, std::span<Values> gradients,
                std::span<float> d_parameters, const GraphBackward& how = {});
  /// The last layer's part of it, a convolution's without activation, for some rows: `first_row`
  /// and what follows it, all that d_output has (ConvolutionLayer::backward_rows).
  void last_backward_rows(const Values& values, int first_row, const Tensor& d_output,
                          Values& gradients, std::span<float> d_parameters);

  /// The layers, for measurements, those that depend on a seed and all behind them called `passes`
  /// times; graph and values must outlive them. An output with fewer channels than its layer gives
  /// is one that is never kept: whoever asks replaces `run`.
  std::vector<NetworkStep> steps(Values& values, int passes = 1);

 private:
  struct Node {
    std::string name;
    std::unique_ptr<Layer> layer;
    std::vector<int> inputs;
    float dropout = 0.0F;
    std::int64_t parameters = 0;
    std::uint64_t dropouts_before = 0;
  };
  /// The first and the last layer that take a tensor.
  struct Users {
    int first = -1;
    int last = -1;
  };
  LayerPass pass_of(int layer, Values& values) const;
  LayerEnd input_gradient_end(int layer, const Values& values, const Values& gradients) const;
  void finish_gradient(int tensor, const Values& values, bool dropped, Values& gradients) const;
  BackwardPass backward_pass(int layer, const Values& values, Values& gradients) const;

  Engine engine_;
  std::vector<TensorShape> shapes_;
  std::vector<Users> users_;                      ///< of each tensor
  std::vector<Node> nodes_;                       ///< node i makes tensor i + 1
  ConvolutionLayer* last_convolution_ = nullptr;  ///< if the last layer is one
};

/// Each value is dropped with a probability of `share`, or else divided by 1 - share, so that the
/// mean stays; seed and place alone decide. Called by all threads of a parallel region, they share
/// the work; borders too.
void drop_out(std::uint64_t seed, float share, Tensor& values);

/// The gradient before, from that behind: nothing for what was dropped, which is 0 now. A value
/// that was 0 before must be one that an activation has cut off and that has no gradient. One
/// thread; borders too.
void drop_out_backward(float share, const Tensor& values, Tensor& gradient);

// The activations are max(v, slope v): slope 0 is ReLU, 0 < slope < 1 leaky ReLU, 1 the identity.
// Convolutions and batch norm apply them to their own result.

/// d_values: d loss / d output in, d loss / d input out; borders filled. The sign of the input is
/// that of the output for every slope > 0, and for slope 0 an output of 0 has derivative 0, as in
/// PyTorch.
void leaky_relu_backward(float slope, const Tensor& output, Tensor& d_values);

}  // namespace hqslam::nn

#pragma once

#include <memory>
#include <span>
#include <vector>

#include "graph/layer_graph.h"
#include "layer_backward.h"

namespace hqslam::nn {

struct BackwardOptions {
  bool dropped = false;  ///< forward did, with a seed
  int left_out = 0;      ///< of the last layers, which have been done already
};

/// The backward pass of a LayerGraph, whose layers are convolutions or implement LayerBackward.
class GraphBackward {
 public:
  using Values = LayerGraph::Values;

  /// The graph must outlive it and gets no more layers. Throws Error if a layer has no gradients.
  explicit GraphBackward(LayerGraph& graph);

  /// The graph's new parameters, which it has already.
  void set_parameters(std::span<const float> parameters);
  /// The scans of a batch, from their first values to their last; a seed each. One thread.
  void forward_batch(std::span<Values> batch, std::span<const std::uint64_t> seeds);
  /// In: the gradients of the output. Out: those of the input; d_parameters is added to. The others
  /// are overwritten: the gradients of what went into their activations. One thread.
  void backward(std::span<const Values> batch, std::span<Values> gradients,
                std::span<float> d_parameters, const BackwardOptions& how = {});
  /// The last layer's part of it, a convolution's without activation, for some rows: `first_row`
  /// and what follows it, all that d_output has (ConvolutionBackward::backward_rows).
  void last_backward_rows(const Values& values, int first_row, const Tensor& d_output,
                          Values& gradients, std::span<float> d_parameters);

 private:
  /// The first and the last layer that take a tensor.
  struct Users {
    int first = -1;
    int last = -1;
  };
  LayerEnd input_gradient_end(int layer, const Values& values, const Values& gradients) const;
  void finish_gradient(int tensor, const Values& values, bool dropped, Values& gradients) const;
  BackwardPass backward_pass(int layer, const Values& values, Values& gradients) const;

  LayerGraph& graph_;
  std::vector<std::unique_ptr<ConvolutionBackward>> convolutions_;
  std::vector<LayerBackward*> layers_;
  std::vector<Users> users_;  ///< of each tensor
};

/// The gradient before a dropout, from that behind it: nothing for what was dropped, which is 0
/// now. A value that was 0 before must be one that an activation has cut off and that has no
/// gradient. One thread; borders too.
void drop_out_backward(float share, const Tensor& values, Tensor& gradient);

/// d_values: d loss / d output in, d loss / d input out, of an activation max(v, slope v); borders
/// filled. The sign of the input is that of the output for every slope > 0, and for slope 0 an
/// output of 0 has derivative 0, as in PyTorch.
void leaky_relu_backward(float slope, const Tensor& output, Tensor& d_values);

}  // namespace hqslam::nn

#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "conv2d.h"
#include "convolution_shape.h"
#include "hqslam/nn/instruction_set.h"
#include "hqslam/nn/network_step.h"
#include "hqslam/nn/parameter_shape.h"
#include "tensor.h"

namespace hqslam::nn {

/// One convolution between two tensors: to = a(convolution(from) + skip + row bias),
/// a(v) = max(v, negative_slope v).
struct ConvolutionStep {
  std::string name;  ///< of its parameters: "encoder.0"
  bool transposed = false;
  int kernel = 3;
  int stride = 1;
  int from = 0;  ///< numbers of tensors
  int to = 1;
  std::optional<int> skip = std::nullopt;  ///< may be `from`: a residual step
  float negative_slope = 1.0F;
  bool row_bias = false;  ///< a learned bias per output channel and row beside the one per channel;
                          ///< not together with a skip
  bool bias = true;       ///< a learned bias per output channel
  float dropout = 0.0F;   ///< the share of its result that training drops
  float start_scale = 1.0F;  ///< of its first weights, in PyTorch's uniform start
};

/// Steps from tensor 0, the input, to the last tensor, the output, each tensor written by one step
/// and used as a skip by at most one. Described once: parameters, multiply-adds, forward and
/// backward follow. Odd kernels of stride 1 or 2 are padded by half of the kernel; a transposed
/// step's kernel is its stride.
class ConvolutionGraph {
 public:
  /// channels: of every tensor; tensor 0 has rows x columns pixels, the others follow. Throws
  /// Error if a shape does not fit.
  ConvolutionGraph(std::vector<ConvolutionStep> steps, const std::vector<int>& channels, int rows,
                   int columns, InstructionSet instruction_set, int threads,
                   ColumnPadding padding = ColumnPadding::kCircular);

  std::vector<ParameterShape> parameter_shapes() const;
  /// PyTorch's start: uniform in +-1 / sqrt(fan in); biases in +-0.1, those of rows 0.
  std::vector<float> initial_parameters(std::uint64_t seed) const;
  std::int64_t multiply_adds() const;
  /// Tensors of the right shapes, all zero.
  std::vector<Tensor> make_values() const { return shapes_; }

  /// All arrays of parameter_shapes(), one after the other. Throws Error for another number.
  void set_parameters(std::span<const float> parameters);

  /// values[0] -> the other values, but for the last `left_out` steps. Called by all threads of a
  /// parallel region, they share the work. With a seed the steps that have dropout drop.
  void forward(std::vector<Tensor>& values, int left_out = 0,
               std::optional<std::uint64_t> dropout_seed = std::nullopt);
  /// The steps of `forward`, for measurements; `values` must outlive them. An output with fewer
  /// channels than its step gives is one that is never kept: whoever asks replaces `run`.
  std::vector<NetworkStep> steps(std::vector<Tensor>& values);
  /// One row of the last step's result, by the calling thread alone (Conv2d::forward_row).
  void last_step_row(const std::vector<Tensor>& values, int row, float* output,
                     std::int64_t channel_stride) const;
  /// In: gradients.back(), borders filled. Out: gradients.front(); d_parameters is added to. The
  /// others are overwritten: the gradients of what went into their activations. One thread.
  /// `dropped`: forward did; what it dropped is 0, as what a ReLU cut off is. `left_out`: so many
  /// of the last steps have been done already; gradients of their results are not looked at.
  void backward(const std::vector<Tensor>& values, std::vector<Tensor>& gradients,
                std::span<float> d_parameters, bool dropped = false, int left_out = 0);
  /// The last step's part of `backward` for some rows, `first_row` and what follows it
  /// (Conv2d::backward_rows); the step has no activation.
  void last_step_backward_rows(const std::vector<Tensor>& values, int first_row,
                               const Tensor& d_output, std::vector<Tensor>& gradients,
                               std::span<float> d_parameters);

 private:
  std::int64_t multiply_adds(std::size_t step) const;
  LayerEnd end_of(std::size_t step, const std::vector<Tensor>& values) const;
  /// How the gradient of a step's input ends.
  LayerEnd input_gradient_end(const ConvolutionStep& step, const std::vector<Tensor>& values,
                              const std::vector<Tensor>& gradients) const;
  /// The tensor whose gradient tensor `index` gets as a skip.
  std::optional<int> used_as_skip_for(int index) const;
  /// The step that made tensor `index`; null for the input.
  const ConvolutionStep* step_before(int index) const;

  std::vector<ConvolutionStep> steps_;
  std::vector<Tensor> shapes_;
  std::vector<Conv2d> layers_;
  std::vector<Tensor> row_biases_;  ///< one per step, of the shape of its result; empty: none
};

}  // namespace hqslam::nn

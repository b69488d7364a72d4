#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "convolution.h"
#include "hqslam/nn/instruction_set.h"
#include "parameters.h"
#include "tensor.h"

namespace hqslam::nn {

/// The instruction set and the threads that a layer computes with.
struct Engine {
  InstructionSet instruction_set = chosen_instruction_set();
  int threads = 1;
};

struct TensorShape {
  int channels = 1;
  int rows = 1;
  int columns = 1;
  ColumnPadding padding = ColumnPadding::kCircular;

  /// All zero.
  Tensor make() const { return {channels, rows, columns, padding}; }
  /// For planning.
  Tensor without_values() const { return Tensor::shape_alone(channels, rows, columns, padding); }
  std::int64_t values() const { return static_cast<std::int64_t>(channels) * rows * columns; }
  bool operator==(const TensorShape&) const = default;
};
inline TensorShape shape_of(const Tensor& tensor) {
  return {tensor.channels(), tensor.rows(), tensor.columns(), tensor.padding()};
}

/// The buffers of one scan in one layer. Tensors have their borders filled.
struct LayerPass {
  const Tensor* input = nullptr;
  const Tensor* second = nullptr;  ///< of a layer with two inputs
  Tensor* output = nullptr;
};

/// One layer of a LayerGraph, made for the shapes of its inputs. Training needs more of it:
/// LayerBackward.
class Layer {
 public:
  explicit Layer(const TensorShape& output) : output_(output) {}
  virtual ~Layer() = default;

  const TensorShape& output_shape() const { return output_; }
  /// In PyTorch's names and layouts.
  virtual std::vector<ParameterShape> parameter_shapes() const { return {}; }
  /// Appends starting values for training.
  virtual void add_initial_parameters(UniformStart& /*start*/,
                                      std::vector<float>& /*parameters*/) const {}
  /// All arrays of parameter_shapes(), one after the other.
  virtual void set_parameters(std::span<const float> /*parameters*/) {}
  virtual std::int64_t multiply_adds() const { return 0; }
  /// The result is max(v, negative_slope v) of what the layer computes.
  virtual float negative_slope() const { return 1.0F; }
  /// Called by all threads of a parallel region, which share the work. The result does not depend
  /// on their number.
  virtual void forward(const LayerPass& pass) = 0;

 protected:
  TensorShape output_;
};

}  // namespace hqslam::nn

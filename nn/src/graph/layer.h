#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "../parameters.h"
#include "../tensor.h"
#include "hqslam/nn/instruction_set.h"

namespace hqslam::nn {

/// What a layer computes with.
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
  std::int64_t values() const { return static_cast<std::int64_t>(channels) * rows * columns; }
};

/// One scan on its way through one layer. Tensors have their borders filled.
struct LayerPass {
  std::vector<const Tensor*> inputs = {};
  Tensor* output = nullptr;
  std::optional<std::uint64_t> seed = std::nullopt;  ///< of what is random; nothing: nothing is

  // Of the way back:
  const Tensor* d_output = nullptr;
  std::vector<Tensor*> d_inputs = {};  ///< added to; their borders are left alone
};

/// One layer of a LayerGraph, made for the shapes of its inputs. layers.h has all of them.
class Layer {
 public:
  explicit Layer(const TensorShape& output) : output_(output) {}
  virtual ~Layer() = default;

  /// Of the result.
  const TensorShape& output_shape() const { return output_; }
  /// In PyTorch's names and layouts.
  virtual std::vector<ParameterShape> parameter_shapes() const { return {}; }
  /// Appends starting values for training.
  virtual void add_initial_parameters(UniformStart& /*start*/,
                                      std::vector<float>& /*parameters*/) const {}
  /// All arrays of parameter_shapes(), one after the other.
  virtual void set_parameters(std::span<const float> /*parameters*/) {}
  virtual std::int64_t multiply_adds() const { return 0; }
  /// Whether the result depends on LayerPass::seed.
  virtual bool is_random() const { return false; }

  /// Called by all threads of a parallel region, they share the work. The result does not depend on
  /// their number.
  virtual void forward(const LayerPass& pass) = 0;
  /// The scans of a batch, which may see each other (batch norm). One thread.
  virtual void forward_training(std::span<const LayerPass> batch) {
    for (const LayerPass& pass : batch) forward(pass);
  }
  /// After forward_training of the same batch. d_parameters is added to. One thread.
  virtual void backward(std::span<const LayerPass> batch, std::span<float> d_parameters) = 0;

 protected:
  TensorShape output_;
};

}  // namespace hqslam::nn

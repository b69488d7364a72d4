#pragma once

#include <memory>
#include <span>
#include <vector>

#include "graph/convolution_layer.h"
#include "graph/layer.h"

namespace hqslam::nn {

/// The gradients of one scan on their way back through one layer.
struct BackwardPass {
  const Tensor* input = nullptr;
  const Tensor* d_output = nullptr;  ///< of what went into the layer's activation
  Tensor* d_input = nullptr;         ///< added to; their borders are left alone
  Tensor* d_second = nullptr;
  /// How a layer that ends_gradients() writes d_input instead: with what is already there, and the
  /// derivative of the activation that made the input.
  LayerEnd end = {};
};

/// What training needs of a layer beside `Layer::forward`.
class LayerBackward {
 public:
  virtual ~LayerBackward() = default;

  /// The layer's new parameters, which it has already.
  virtual void set_parameters(std::span<const float> /*parameters*/) {}
  /// Whether `backward` writes d_input, borders too, as BackwardPass::end specifies.
  virtual bool ends_gradients() const { return false; }
  /// The scans of a batch together, because their results may depend on each other (batch norm).
  /// One thread.
  virtual void forward_batch(std::span<const LayerPass> batch) = 0;
  /// After `forward` or forward_batch of the same scans. d_parameters is added to. One thread.
  virtual void backward(std::span<const BackwardPass> batch, std::span<float> d_parameters) = 0;
};

/// A layer with its backward pass in one object, which no network for upsampling alone contains.
class TrainableLayer : public Layer, public LayerBackward {
 public:
  using Layer::Layer;
  void set_parameters(std::span<const float> /*parameters*/) override {}
  void forward_batch(std::span<const LayerPass> batch) override {
    for (const LayerPass& pass : batch) forward(pass);
  }
  void backward(std::span<const BackwardPass> batch, std::span<float> d_parameters) override {
    for (const BackwardPass& pass : batch) backward_scan(pass, d_parameters);
  }

 protected:
  /// `backward` of a layer whose scans do not depend on each other.
  virtual void backward_scan(const BackwardPass& /*pass*/, std::span<float> /*d_parameters*/) {}
};

/// The backward pass of ConvolutionLayer.
class ConvolutionBackward final : public LayerBackward {
 public:
  ConvolutionBackward(ConvolutionLayer& layer, const Engine& engine);

  void set_parameters(std::span<const float> parameters) override;
  bool ends_gradients() const override { return true; }
  void forward_batch(std::span<const LayerPass> batch) override;
  void backward(std::span<const BackwardPass> batch, std::span<float> d_parameters) override;
  /// All gradients from some rows of the result alone, `first_row` and what follows it, which is
  /// all that d_output has, while they are in the cache. One thread. Throws Error unless stride and
  /// kernel rows are 1.
  void backward_rows(const Tensor& input, int first_row, const Tensor& d_output,
                     const LayerEnd& end, Tensor& d_input, std::span<float> d_parameters);

 private:
  void backward_by_row(const BackwardPass& pass, std::span<float> d_parameters);
  void backward_input(const Tensor& d_output, const LayerEnd& end, Tensor& d_input);

  ConvolutionLayer& layer_;
  std::optional<kernels::WinogradConvolution> adjoint_;  ///< of a layer that is computed like this
};

}  // namespace hqslam::nn

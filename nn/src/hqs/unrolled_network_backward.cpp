#include <fmt/format.h>

#include "channels.h"
#include "hqslam/core/error.h"
#include "rejected_pixels.h"
#include "unrolled_network.h"

// The gradients of the unrolled loop, layer by layer from the last to the first.
namespace hqslam::nn {

struct UnrolledNetwork::BackwardScratch {
  DenoiserState gradient;
  Tensor d_z;
  Tensor d_y;
  Tensor d_h;
  Tensor d_a;
};

void UnrolledNetwork::backward_y(const LayerState& layer, const Tensor& d_y, Tensor& d_h,
                                 Tensor& d_z) const {
  const TileSize tile = denoisers_.front()->tile();
  const bool of_h = options_.filtered == FilteredIterate::kH;
  const bool zero = options_.rejected == RejectedPixel::kZero;
  // As if nothing were rejected, then what is.
  if (of_h) {
    d_h = d_y;
  } else {
    d_h.set_zero();
    add_channels(d_y, tile.pixels(), d_z);
  }
  for (int row = 0; row < d_y.rows(); ++row) {
    for_each_rejected(layer.rejected, tile, columns_, row, [&](int channel, int x) {
      const float gradient = d_y.row(channel, row)[x];
      d_h.row(channel, row)[x] = 0.0F;
      if (of_h && !zero) d_z.row(channel, row)[x] += gradient;
      if (!of_h && zero) d_z.row(channel, row)[x] -= gradient;
    });
  }
}

void UnrolledNetwork::add_penalty_gradient(int layer, double d_penalty,
                                           std::span<float> d_parameters) const {
  if (options_.penalty == Penalty::kAlpha) {
    // b = 1 / (2 alpha)
    d_parameters.back() += static_cast<float>(-d_penalty * 0.5 / (alpha_ * alpha_));
  } else {
    d_parameters[d_parameters.size() - options_.layers + layer] +=
        static_cast<float>(d_penalty * penalty_[layer]);
  }
}

void UnrolledNetwork::backward(const UnrolledState& state, std::span<const Tensor> d_z,
                               std::span<float> d_parameters) {
  if (static_cast<int>(state.slots.size()) != options_.layers) {
    throw Error(fmt::format("network: a state that kept {} of {} layers, expected all of them",
                            state.slots.size(), options_.layers));
  }
  if (d_z.empty() || static_cast<int>(d_z.size()) > options_.layers) {
    throw Error(fmt::format("network: gradients of {} layers, expected of 1 to {}", d_z.size(),
                            options_.layers));
  }
  const bool z_alone = options_.auxiliaries == Auxiliaries::kZ;
  const Denoiser& any = *denoisers_.front();
  const int pixels = any.tile().pixels();
  const int memory = any.memory_channels();
  if (backward_ == nullptr) {
    backward_ = std::make_shared<BackwardScratch>(
        BackwardScratch{any.make_state(), state.z0, state.z0, state.z0, state.z0});
  }
  BackwardScratch& scratch = *backward_;
  DenoiserState& gradient = scratch.gradient;
  scratch.d_z.set_zero();
  scratch.d_y.set_zero();
  const int first_memory = gradient.output().channels() - memory;
  if (memory > 0) clear_channels(first_memory, gradient.output());
  for (int layer = options_.layers - 1; layer >= 0; --layer) {
    const LayerState& current = state.layer(layer);
    const bool last = layer + 1 == options_.layers;
    if (last || z_alone) {
      scratch.d_h.set_zero();
    } else {
      backward_y(current, scratch.d_y, scratch.d_h, scratch.d_z);
    }
    const int from_end = options_.layers - 1 - layer;
    if (from_end < static_cast<int>(d_z.size())) {
      add_channels(d_z[d_z.size() - 1 - from_end], pixels, scratch.d_z);
    }
    gradient.z = scratch.d_z;
    const std::size_t begin = options_.shared_weights ? 0 : layer * denoiser_parameters_;
    denoiser(layer).backward(state.candidates, current.denoiser, gradient,
                             d_parameters.subspan(begin, denoiser_parameters_));
    add_channels(gradient.input(), pixels, scratch.d_h);
    const double d_penalty = data_consistency(layer).backward(
        state.l, previous_z(state, layer), previous_y(state, layer), scratch.d_h, scratch.d_a);
    add_penalty_gradient(layer, d_penalty, d_parameters);
    if (memory > 0)
      copy_channels(gradient.input(), pixels, memory, gradient.output(), first_memory);
    // A is the mean of Z and Y; without Y it is Z.
    for (int channel = 0; channel < pixels; ++channel) {
      for (int row = 0; row < scratch.d_a.rows(); ++row) {
        const float* from = scratch.d_a.row(channel, row);
        float* to_z = scratch.d_z.row(channel, row);
        float* to_y = scratch.d_y.row(channel, row);
        for (int x = 0; x < scratch.d_a.columns(); ++x) {
          to_z[x] = z_alone ? from[x] : 0.5F * from[x];
          to_y[x] = z_alone ? 0.0F : 0.5F * from[x];
        }
      }
    }
  }
}

}  // namespace hqslam::nn

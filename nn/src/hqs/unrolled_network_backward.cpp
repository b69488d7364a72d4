#include <fmt/format.h>

#include "channels.h"
#include "hqslam/core/error.h"
#include "rejected_pixels.h"
#include "unrolled_network.h"

// The gradients of the unrolled loop, layer by layer from the last to the first.
namespace hqslam::nn {

struct UnrolledNetwork::BackwardScratch {
  DenoiserState gradient;
  Tensor d_h;
  Tensor d_a;  ///< of the layer above: A is the mean of its Z and Y; without Y it is Z
};

/// to = a + share b
static void add_scaled(const float* a, float share, const float* b, int columns, float* to) {
  for (int x = 0; x < columns; ++x) to[x] = a[x] + share * b[x];
}

/// d loss / d Z: what the loss says (null: nothing), and what the layer above passes on through its
/// A; where this layer's Y is Z, twice.
void UnrolledNetwork::gather_d_z(int layer, const LayerState& current, const Tensor* d_loss,
                                 const Tensor& d_a, Tensor& d_z) const {
  const TileSize tile = denoisers_.front()->tile();
  const bool has_y = has_filter_after(layer);
  const bool z_alone = options_.auxiliaries == Auxiliaries::kZ;
  const float share = z_alone || (has_y && !filters_h()) ? 1.0F : 0.5F;
  const bool zero = options_.rejected == RejectedPixel::kZero;
  for (int channel = 0; channel < tile.pixels(); ++channel) {
    for (int row = 0; row < d_z.rows(); ++row) {
      const float* passed = d_a.row(channel, row);
      float* to = d_z.row(channel, row);
      if (d_loss != nullptr) {
        add_scaled(d_loss->row(channel, row), share, passed, d_z.columns(), to);
      } else {
        for (int x = 0; x < d_z.columns(); ++x) to[x] = share * passed[x];
      }
    }
  }
  if (!has_y || filters_h() == zero) return;
  const float more = zero ? -0.5F : 0.5F;
  for (int row = 0; row < d_z.rows(); ++row) {
    for_each_mask(current.rejected, tile, columns_, row,
                  [&](int channel, int first, int count, const std::uint32_t* mask) {
                    const float* passed = d_a.row(channel, row) + first;
                    float* to = d_z.row(channel, row) + first;
#pragma omp simd
                    for (int i = 0; i < count; ++i) {
                      to[i] += (mask[i] != 0 ? more : 0.0F) * passed[i];
                    }
                  });
  }
}

/// d loss / d H: through the denoiser, and where this layer's Y is H.
void UnrolledNetwork::gather_d_h(int layer, const LayerState& current, const Tensor& d_input,
                                 const Tensor& d_a, Tensor& d_h) const {
  const TileSize tile = denoisers_.front()->tile();
  const float share = has_filter_after(layer) && filters_h() ? 0.5F : 0.0F;
  for (int row = 0; row < d_h.rows(); ++row) {
    for_each_mask(current.rejected, tile, columns_, row,
                  [&](int channel, int first, int count, const std::uint32_t* mask) {
                    const float* of_input = d_input.row(channel, row) + first;
                    const float* passed = d_a.row(channel, row) + first;
                    float* to = d_h.row(channel, row) + first;
#pragma omp simd
                    for (int i = 0; i < count; ++i) {
                      to[i] = of_input[i] + (mask[i] != 0 ? 0.0F : share) * passed[i];
                    }
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
  const Denoiser& any = *denoisers_.front();
  const int pixels = any.tile().pixels();
  const int memory = any.memory_channels();
  if (backward_ == nullptr) {
    backward_ =
        std::make_shared<BackwardScratch>(BackwardScratch{any.make_gradient(), state.z0, state.z0});
  }
  BackwardScratch& scratch = *backward_;
  DenoiserState& gradient = scratch.gradient;
  scratch.d_a.set_zero();
  const int first_memory = gradient.output().channels() - memory;
  if (memory > 0) clear_channels(first_memory, gradient.output());
  for (int layer = options_.layers - 1; layer >= 0; --layer) {
    const LayerState& current = state.layer(layer);
    const int of_loss = static_cast<int>(d_z.size()) - (options_.layers - layer);
    gather_d_z(layer, current, of_loss < 0 ? nullptr : &d_z[of_loss], scratch.d_a, gradient.z);
    const std::size_t begin = options_.shared_weights ? 0 : layer * denoiser_parameters_;
    denoiser(layer).backward(state.candidates, current.denoiser, gradient,
                             d_parameters.subspan(begin, denoiser_parameters_));
    gather_d_h(layer, current, gradient.input(), scratch.d_a, scratch.d_h);
    const double d_penalty = data_consistency(layer).backward(
        state.l, previous_z(state, layer), previous_y(state, layer), scratch.d_h, scratch.d_a);
    add_penalty_gradient(layer, d_penalty, d_parameters);
    if (memory > 0)
      copy_channels(gradient.input(), pixels, memory, gradient.output(), first_memory);
  }
}

}  // namespace hqslam::nn

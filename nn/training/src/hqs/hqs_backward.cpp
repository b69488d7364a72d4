#include "hqs_backward.h"

// The gradients of the loop, layer by layer from the last to the first.
namespace hqslam::nn {
namespace {

/// d A / d Z or d A / d H of the layer above, A = (Z + Y) / 2, in a pixel that the filter keeps and
/// in one that it rejects.
struct PassedShares {
  float kept = 0.0F;
  float rejected = 0.0F;
};
PassedShares shares_of_z(const Hqs& hqs) {
  if (!hqs.has_y()) return {1.0F, 1.0F};
  if (hqs.of_h()) return {0.5F, hqs.takes_other() ? 1.0F : 0.5F};
  return {1.0F, 0.5F};
}
PassedShares shares_of_h(const Hqs& hqs) {
  if (!hqs.has_y()) return {};
  if (hqs.of_h()) return {0.5F, 0.0F};
  return {0.0F, hqs.takes_other() ? 0.5F : 0.0F};
}

/// d loss / d Z: the gradient of this layer's loss plus what the layer above passes on through its
/// A.
void add_passed_to_z(const Hqs& hqs, const HqsLayer& layer, const Tensor& d_a, Tensor& d_z) {
  const TileSize tile = hqs.prior(0).tile();
  const PassedShares share = shares_of_z(hqs);
  for (int row = 0; row < d_z.rows(); ++row) {
    for (int channel = 0; channel < tile.pixels(); ++channel) {
      const float* passed = d_a.row(channel, row);
      float* to = d_z.row(channel, row);
      for (int x = 0; x < d_z.columns(); ++x) to[x] = to[x] + share.kept * passed[x];
    }
    if (!hqs.has_y()) continue;
    const float more = share.rejected - share.kept;
    for_each_mask(layer.rejected, tile, d_z.columns() * tile.columns, row,
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

/// d loss / d H: through the prior, and through this layer's Y.
void gather_d_h(const Hqs& hqs, const HqsLayer& layer, PassedShares share,
                const HqsGradient& gradient, Tensor& d_h) {
  const TileSize tile = hqs.prior(0).tile();
  for (int row = 0; row < d_h.rows(); ++row) {
    for_each_mask(layer.rejected, tile, d_h.columns() * tile.columns, row,
                  [&](int channel, int first, int count, const std::uint32_t* mask) {
                    const float* of_input = gradient.prior.input().row(channel, row) + first;
                    const float* passed = gradient.d_a.row(channel, row) + first;
                    float* to = d_h.row(channel, row) + first;
#pragma omp simd
                    for (int i = 0; i < count; ++i) {
                      to[i] =
                          of_input[i] + (mask[i] != 0 ? share.rejected : share.kept) * passed[i];
                    }
                  });
  }
}

/// From d loss / d H to d loss / d A of the layer before; returns d loss / d b.
double data_step_gradient(const Hqs& hqs, int k, const HqsState& state, HqsGradient& gradient) {
  const Tensor& z = hqs.z_before(k, state);
  const Tensor& y = hqs.y_before(k, state);
  double d_penalty = 0.0;
  for (int channel = 0; channel < hqs.prior(k).tile().pixels(); ++channel) {
    for (int row = 0; row < z.rows(); ++row) {
      d_penalty += data_consistency_gradient_row(hqs.measurement.l_row(channel, row),
                                                 z.row(channel, row), y.row(channel, row),
                                                 gradient.d_h.row(channel, row), hqs.penalty[k],
                                                 z.columns(), gradient.d_a.row(channel, row));
    }
  }
  return d_penalty;
}

/// The penalty is learned as ln b of each layer or as alpha = 1 / (2 b), one for all.
void add_penalty_gradient(const Hqs& hqs, int k, double d_penalty, std::span<float> d_parameters) {
  const double b = hqs.penalty[k];
  if (hqs.preset.learns_alpha) {
    d_parameters.back() += static_cast<float>(-d_penalty * 0.5 / (hqs.alpha * hqs.alpha));
  } else {
    const std::size_t penalties = hqs.priors.size();
    d_parameters[d_parameters.size() - penalties + k % penalties] +=
        static_cast<float>(d_penalty * b);
  }
}

}  // namespace

HqsGradient::HqsGradient(Hqs& hqs)
    : prior_parameters(hqs.prior(0).parameters()), d_h(hqs.z0), d_a(hqs.z0) {
  for (const std::unique_ptr<Prior>& any : hqs.priors) priors.push_back(backward_of(*any));
  prior = priors.front()->make_gradient();
}

void HqsGradient::take_parameters(std::span<const float> parameters) {
  for (const auto& any : priors) any->take_parameters(take(parameters, prior_parameters));
}

double data_consistency_gradient_row(const float* l, const float* z, const float* y,
                                     const float* d_h, float penalty, int columns, float* d_a) {
  if (l == nullptr) {
    std::copy_n(d_h, columns, d_a);
    return 0.0;
  }
  const float scale = 1.0F + 2.0F * penalty;
  float sum = 0.0F;
#pragma omp simd reduction(+ : sum)
  for (int x = 0; x < columns; ++x) {
    // d H / d b = 2 (A - L) / (1 + 2 b)^2
    sum += d_h[x] * (z[x] + y[x] - 2.0F * l[x]);
    d_a[x] = d_h[x] * 2.0F * penalty / scale;
  }
  return static_cast<double>(sum) / (static_cast<double>(scale) * scale);
}

double hqs_backward(Hqs& hqs, const HqsState& state, const LayerLoss& loss, HqsGradient& gradient,
                    std::span<float> d_parameters) {
  const Prior& any = hqs.prior(0);
  const int memory = any.memory_channels();
  const int first_memory = gradient.prior.output().channels() - memory;
  double of_last = 0.0;
  if (memory > 0) clear_channels(first_memory, gradient.prior.output());
  for (int k = hqs.layers - 1; k >= 0; --k) {
    const HqsLayer& layer = state.layer(k);
    const bool last = k + 1 == hqs.layers;
    const double of_layer = loss(k, layer.prior, gradient.prior);
    if (last) {
      of_last = of_layer;
      gradient.d_a.set_zero();
    } else {
      add_passed_to_z(hqs, layer, gradient.d_a, gradient.prior.z);
    }
    const std::int64_t begin = hqs.priors.size() == 1 ? 0 : k * gradient.prior_parameters;
    gradient.backward(k).backward(hqs.measurement.candidates(), layer.prior, gradient.prior,
                                  d_parameters.subspan(begin, gradient.prior_parameters));
    if (!hqs.preset.learned_penalty) break;  // there is one layer, and nothing before it learns
    gather_d_h(hqs, layer, last ? PassedShares{} : shares_of_h(hqs), gradient, gradient.d_h);
    const double d_penalty = data_step_gradient(hqs, k, state, gradient);
    if (hqs.learns_penalty) add_penalty_gradient(hqs, k, d_penalty, d_parameters);
    if (memory > 0) {
      copy_channels(gradient.prior.input(), any.tile().pixels(), memory, gradient.prior.output(),
                    first_memory);
    }
  }
  return of_last;
}

}  // namespace hqslam::nn

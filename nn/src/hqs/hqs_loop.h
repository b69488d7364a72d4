#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "hqs_architecture.h"
#include "hqslam/core/range_image.h"
#include "hqslam/nn/hqs/outlier_removal.h"
#include "prior.h"

namespace hqslam::nn {

/// What one layer computed.
struct HqsLayer {
  PriorState prior;                    ///< h() is H, z is Z
  Tensor y;                            ///< tiles of Y, where there is a filter
  std::vector<std::uint8_t> rejected;  ///< its mask: 1 where it rejects H's pixel; rows x columns
};

/// One scan on its way, with memory for everything it needs: after it was made nothing allocates.
struct HqsState {
  HqsLayer& layer(int k) { return slots[k % slots.size()]; }
  const HqsLayer& layer(int k) const { return slots[k % slots.size()]; }

  /// Of all layers, or of two, which are enough for a result and stay in the processor's cache:
  /// layer k is in slot k mod the number of slots.
  std::vector<HqsLayer> slots;
  bool last_y = false;  ///< the last layer's Y is wanted too, which no other layer needs
};

/// What the loop puts together, for images of one size and one thread team.
struct Hqs {
  /// Of a description whose architecture is HqsArchitecture.
  Hqs(const NetworkDescription& description, int columns, const Engine& engine);

  /// All arrays of parameter_shapes(description), one after the other. Throws Error.
  void set_parameters(std::span<const float> parameters);
  /// With what `hqs_backward` needs, or only with what a result needs.
  HqsState make_state(bool for_backward) const;

  Prior& prior(int k) { return *priors[k % priors.size()]; }
  const Prior& prior(int k) const { return *priors[k % priors.size()]; }
  /// Whether Y is filtered, so that somebody sees it; otherwise Y = Z.
  bool filters(int k, const HqsState& state) const {
    return preset.filters && (k + 1 < layers || state.last_y);
  }
  const Tensor& z_before(int k, const HqsState& s) const {
    return k == 0 ? z0 : s.layer(k - 1).prior.z;
  }
  const Tensor& y_before(int k, const HqsState& s) const {
    return k == 0 ? z0 : preset.filters ? s.layer(k - 1).y : s.layer(k - 1).prior.z;
  }

  HqsPreset preset;
  int layers;                                  ///< K
  std::vector<std::unique_ptr<Prior>> priors;  ///< of each layer, or one for all
  std::unique_ptr<ScaledRanges> scaled;
  Measurement& measurement;    ///< the prior's own, or `scaled`
  std::vector<float> penalty;  ///< b of each layer
  float alpha = 1.0F;          ///< of presets that share it
  OutlierRemoval filter;
  float nearest;                ///< what is nearer is no return for the filter; the loop's unit
  Tensor z0;                    ///< Z and Y before the first layer
  std::vector<float> raster{};  ///< rows x columns: an image without tiles, for the filter
};

/// Eq. 10: start; for each layer k: H by data consistency, Z by the prior, Y by the filter. The
/// last layer's Z is the result. measured_m: the measured rows, metres. Called by all threads of a
/// parallel region.
void hqs_loop(Hqs& hqs, const RangeImage& measured_m, HqsState& state, const PriorPass& pass);

/// Its step of eq. 10a alone, to be measured.
void data_step(Hqs& hqs, int k, HqsState& state);

/// Says the loss of layer k and writes its gradient (Prior::loss).
using LayerLoss = std::function<double(int k, const PriorState& state, PriorState& gradient)>;
/// What hqs_backward works in.
struct HqsGradient {
  explicit HqsGradient(const Hqs& hqs)
      : prior(hqs.prior(0).make_gradient()), d_h(hqs.z0), d_a(hqs.z0) {}
  PriorState prior;
  Tensor d_h;
  Tensor d_a;  ///< of the layer above: A is the mean of its Z and Y; without Y it is Z
};
/// From the last layer to the first, after hqs_loop with a state for it; the filter's masks are
/// constants. Adds to d_parameters and returns the last layer's loss. By a team of one thread.
double hqs_backward(Hqs& hqs, const HqsState& state, const LayerLoss& loss, HqsGradient& scratch,
                    std::span<float> d_parameters);

}  // namespace hqslam::nn

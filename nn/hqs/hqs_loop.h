#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "hqs_architecture.h"
#include "hqslam/core/range_image.h"
#include "hqslam/nn/hqs/outlier_removal.h"
#include "hqslam/nn/network.h"
#include "prior.h"

namespace hqslam::nn {

/// What one layer computed.
struct HqsLayer {
  PriorState prior;                    ///< h() is H, z is Z
  Tensor y;                            ///< tiles of Y, where there is a filter
  std::vector<std::uint8_t> rejected;  ///< its mask: 1 where it rejects H's pixel; rows x columns
};

/// The buffers of one scan in the loop; nothing allocates after they were made.
struct HqsState {
  HqsLayer& layer(int k) { return slots[k % slots.size()]; }
  const HqsLayer& layer(int k) const { return slots[k % slots.size()]; }

  /// All layers, or two, which are enough for a result and stay in the processor's cache: layer k
  /// is in slot k mod the number of slots.
  std::vector<HqsLayer> slots;
  bool last_y = false;  ///< the last layer's Y is wanted too, which no other layer needs
};

/// The parts of the loop, for images of one size and one thread team.
struct Hqs {
  /// description: its architecture is an HqsArchitecture.
  Hqs(const NetworkDescription& description, int columns, const Engine& engine);

  /// All arrays of parameter_shapes(description), one after the other. Throws Error.
  void set_parameters(std::span<const float> parameters);
  /// With all that a trace and the backward pass need, or only with what a result needs.
  HqsState make_state(bool for_backward) const;

  Prior& prior(int k) { return *priors[k % priors.size()]; }
  const Prior& prior(int k) const { return *priors[k % priors.size()]; }
  /// Whether layer k makes a Y of its own; no other layer needs the last one's.
  bool makes_y(int k, const HqsState& state) const {
    return has_y() && (k + 1 < layers || state.last_y);
  }
  bool has_filter() const { return sizes.filter.min_pixels > 0; }
  /// Y = Z where there is no second auxiliary, or Z is not filtered.
  bool has_y() const { return preset.has_y && (of_h() || has_filter()); }
  bool of_h() const { return sizes.filtered_iterate == FilteredIterate::kH; }
  bool takes_other() const { return sizes.rejected_pixel == RejectedPixel::kTakesOther; }
  const Tensor& z_before(int k, const HqsState& s) const {
    return k == 0 ? z0 : s.layer(k - 1).prior.z;
  }
  const Tensor& y_before(int k, const HqsState& s) const {
    return k == 0 ? z0 : has_y() ? s.layer(k - 1).y : s.layer(k - 1).prior.z;
  }

  HqsPreset preset;
  HqsSizes sizes;
  int layers;  ///< K
  bool learns_penalty;
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
/// last layer's Z is the result. Called by all threads of a parallel region.
void hqs_loop(Hqs& hqs, const Observation& seen, HqsState& state, const PriorPass& pass);

/// Its step of eq. 10a alone, to be measured.
void data_step(Hqs& hqs, int k, HqsState& state);

/// The step that keeps the image true to what was measured: eq. 10a, solved pixel by pixel. With
/// A = (Z + Y) / 2, the mean of the two auxiliaries, and b >= 0 the penalty:
///   measured pixels:  H = (L + 2 b A) / (1 + 2 b);   b -> 0: what was measured stays
///   other pixels:     H = A
/// Differs from the paper, whose eq. 7 and 10a have D^T Y where D^T L is meant; D^T D is 0 or 1 on
/// each pixel, so no matrix is inverted. Earlier scans add 1/2 |W (M - H)|^2 to eq. 3, which stays
/// in closed form (recall_row), with W^2 in units of 2 b:
///   other pixels:     H = (W^2 M + A) / (W^2 + 1)
///
/// One row of pixels, in any one unit. l: measured ranges; null: none of them is measured.
void data_consistency_row(const float* l, const float* z, const float* y, float penalty,
                          int columns, float* h);

/// H of a row of other pixels with what is recalled there: h + share (m - h), share = W^2 / (W^2 +
/// 1).
void recall_row(const float* m, const float* share, int columns, float* h);

/// Calls visit(channel, first, count, mask) for all pixels of a row of tiles, a part of a channel
/// at a time: mask[i] is not 0 where the filter rejected the pixel in column first + i. rejected:
/// of the image, its rows `columns` long, not 0 where a pixel is rejected.
template <typename Visit>
void for_each_mask(const std::vector<std::uint8_t>& rejected, TileSize tile, int columns, int row,
                   const Visit& visit) {
  constexpr int kMostPixels = 64;
  std::array<std::uint32_t, kMostPixels> mask;
  for (int channel = 0; channel < tile.pixels(); ++channel) {
    const int image_row = row * tile.rows + channel / tile.columns;
    const std::uint8_t* from = rejected.data() + static_cast<std::size_t>(image_row) * columns;
    const int column = channel % tile.columns;
    for (int first = 0; first < columns / tile.columns; first += kMostPixels) {
      const int count = std::min(kMostPixels, columns / tile.columns - first);
      if (tile.columns == 4) {  // the usual size: the bytes of a tile's row as a number
        for (int i = 0; i < count; ++i) {
          std::uint32_t tile_row = 0;
          std::memcpy(&tile_row, from + 4 * (first + i), 4);
          mask[i] = tile_row & (0xFFU << (8 * column));
        }
      } else {
        for (int i = 0; i < count; ++i) mask[i] = from[(first + i) * tile.columns + column];
      }
      visit(channel, first, count, mask.data());
    }
  }
}

}  // namespace hqslam::nn

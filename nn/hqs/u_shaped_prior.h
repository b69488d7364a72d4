#pragma once

#include <functional>
#include <vector>

#include "prior.h"

namespace hqslam::nn {

/// The end of the U-shaped denoiser. The network scores four candidates for each pixel and adds a
/// correction:
///   Z = w_a above + w_b below + w_h H + r,   (w_a, w_b, w_h, w_0) = softmax(gain scores)
/// above and below: the nearest measured rows, in L or in H (UShapedPriorShape::neighbours_of_h);
/// w_0 is the weight of "no return". At a depth jump a sum of features and ranges would have to
/// hit the one range or the other exactly, or leave a point hovering between them; a choice only
/// has to be clear.
///
/// scores holds 5 groups of tile.pixels() channels: above, below, here, nothing, r.
inline constexpr int kSelectionGroups = 5;
/// AdamW moves every weight by the same step; scores must become large before a choice is clear,
/// while ranges (in units of 80 m) stay below 1.
inline constexpr float kSelectionGain = 4.0F;

/// DU-OR's denoiser: strided convolutions down, transposed convolutions up, on tiles of pixels.
///   encoder.0     3x3, tile.pixels() + memory -> channels[0]
///   encoder.i     3x3, stride 2, channels[i - 1] -> channels[i]
///   bottleneck    3x3, the last channels -> as many
///   decoder.i     2x2 transposed, stride 2, channels[i + 1] -> channels[i], plus encoder.i
///   head          1x1, channels[0] -> 5 tile.pixels() scores and corrections, memory
/// with leaky ReLU after all but the head, whose result goes to `select` (below). The paper
/// gives no sizes.
struct UShapedPriorShape {
  TileSize tile{4, 4};
  std::vector<int> channels{24, 32};
  int memory = 16;
  float negative_slope = 0.0F;
  /// The paper's Z = G(H): the choice at the end is among ranges of H. Otherwise the neighbours
  /// are taken from L, and Z is a function of H and L, which leaves nothing to do for eq. 10a.
  bool neighbours_of_h = false;

  int scores() const { return kSelectionGroups * tile.pixels(); }
};

/// The candidates of row `row` of channel `channel`.
using CandidatesOf = std::function<CandidateRows(int channel, int row)>;

class UShapedPrior final : public Prior {
 public:
  UShapedPrior(const UShapedPriorShape& shape, LayerGraph graph, const NetworkDescription& network,
               const Engine& engine);

  const UShapedPriorShape& shape() const { return shape_; }
  int memory_channels() const override { return shape_.memory; }
  PriorState make_state(bool for_backward) const override;
  void take_row(int row, const PriorState* before, PriorState& state) override;
  void forward(const Candidates& candidates, PriorState& state, const PriorPass& pass) override;
  void add_inner(const Measurement& measurement, const PriorState& state, const std::string& prefix,
                 Trace& trace) const override;

  /// The neighbours that the choice is among: of L, or of h, which must outlive what is returned.
  CandidatesOf candidates_of(const Candidates& measured, const Tensor& h) const;
  /// In tiles of an image, the row of pixels that is above or below that of a channel's row, in the
  /// same columns: neighbours_of_h alone.
  template <typename TensorType>
  auto* above(int channel, int row, TensorType& tiles) const {
    return in_image_row(above_[image_row(channel, row)], channel, tiles);
  }
  template <typename TensorType>
  auto* below(int channel, int row, TensorType& tiles) const {
    return in_image_row(below_[image_row(channel, row)], channel, tiles);
  }

 private:
  /// Head and selection one row after the other: a row of scores never leaves the cache. Leaves the
  /// weights, too, where the state has room for them.
  void select_by_row(const Candidates& candidates, PriorState& state);
  template <typename TensorType>
  auto* in_image_row(int image_row, int channel, TensorType& tiles) const {
    const int column = channel % shape_.tile.columns;
    return tiles.row(image_row % shape_.tile.rows * shape_.tile.columns + column,
                     image_row / shape_.tile.rows);
  }
  int image_row(int channel, int row) const {
    return row * shape_.tile.rows + channel / shape_.tile.columns;
  }

  UShapedPriorShape shape_;
  std::vector<int> above_;  ///< of each image row the measured row above it, of neighbours_of_h
  std::vector<int> below_;
  std::vector<std::vector<float>> head_rows_;  ///< a row of the head's result, one per thread
};

/// Throws Error with field, value and constraint.
PriorDescription u_shaped_prior(const UShapedPriorShape& shape);
PriorDescription read_u_shaped_prior(JsonFields& sizes);

/// Z of one row, by the calling thread alone. scores: groups of channels as above, channel_stride
/// floats apart; in the scores, out the softmax.
void select_row(const CandidatesOf& candidates, const Tensor& h, TileSize tile,
                InstructionSet instruction_set, int row, float* scores, std::int64_t channel_stride,
                Tensor& z);

}  // namespace hqslam::nn

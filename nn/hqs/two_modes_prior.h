#pragma once

#include <optional>
#include <vector>

#include "kernels/row_kernels.h"
#include "kernels/two_modes.h"
#include "prior.h"

namespace hqslam::nn {

/// DU-Mix's prior, on tiles that have one measured row each:
///   encoder.0      3x3 with a bias per row, the input -> channels
///   encoder.1      3x3, stride 2, channels -> lower_channels
///   bottleneck.0   3x3, lower_channels -> as many
///   bottleneck.i   3x3 plus its input, i = 1 to residual_blocks
///   decoder.0      2x2 transposed, stride 2, lower_channels -> channels, plus encoder.0
///   head           1x1, channels -> 7 outputs (kernels/two_modes.h) of every computed pixel,
///                  9 with a memory
/// with leaky ReLU after all but the head. For any table of beams the head has weights for each
/// row, and the input has L of the measured row in the place of H. The input: (H - ln 20) / 2,
/// where something was measured, and ln above - ln below of the measured rows; with a memory also M
/// minus the start (of a measured pixel minus L) within +-1, and W^2 / (W^2 + 1) - 1/2, for any
/// table of beams in four rows, whatever the tile has. Z is the likelier mode, all in y = ln(range
/// in metres); what is known to a centimetre needs no penalty, so b -> 0.
struct TwoModesShape {
  TileSize tile{4, 4};
  int channels = 48;
  int lower_channels = 72;
  int residual_blocks = 4;
  float negative_slope = 0.1F;
  int memory = 16;           ///< unused, because there is one layer; files have it
  bool scan_memory = false;  ///< uses M and W of earlier scans (RecalledImage)
  bool any_beams = false;    ///< one set of parameters for all tables of beams (BeamParameters)
};

class TwoModesPrior final : public Prior {
 public:
  TwoModesPrior(const TwoModesShape& shape, LayerGraph graph, const NetworkDescription& description,
                int columns, const Engine& engine);

  Measurement* measurement() override { return &ranges_; }
  PriorState make_state(bool for_backward) const override;
  void take_row(int row, const PriorState* before, PriorState& state) override;
  void forward(const Candidates& candidates, PriorState& state, const PriorPass& pass) override;
  void add_inner(const Measurement& measurement, const PriorState& state, const std::string& prefix,
                 Trace& trace) const override;

  const kernels::RowKernels& row_kernels() const { return kernels_; }
  const LogRanges& ranges() const { return ranges_; }
  int computed_pixels() const { return pixels_; }  ///< of a tile
  /// What the kernels take of a computed pixel; outputs: of the head in this row.
  kernels::TwoModesInput modes_input(const PriorState& state, int pixel, int row,
                                     const float* outputs, std::int64_t channel_stride) const;

 private:
  Tensor tiles(int channels) const {
    return {channels, ranges_.rows(), ranges_.columns(), padding()};
  }
  void compute_modes(PriorState& state, const PriorPass& pass);
  void finish_image_row(int row, const float* ranges, const float* confidences,
                        UpsampledImage& upsampled) const;

  NetworkDescription description_;
  std::vector<std::optional<int>> recalled_rows_;  ///< those of a tile in the input; empty: none
  const kernels::RowKernels& kernels_;
  LogRanges ranges_;
  int pixels_;                               ///< of a tile that are computed
  int outputs_;                              ///< of each of them
  std::int64_t stride_ = 0;                  ///< between the rows of scratch_
  std::vector<std::vector<float>> scratch_;  ///< for each thread
};

/// Throws Error with field, value and constraint.
PriorDescription two_modes_prior(const TwoModesShape& shape);
PriorDescription read_two_modes_prior(JsonFields& sizes);

}  // namespace hqslam::nn

#pragma once

#include <vector>

#include "../graph/layer.h"
#include "../kernels/row_kernels.h"
#include "measurement.h"

namespace hqslam::nn {

/// A pixel of a tile that is not measured.
struct ComputedPixel {
  int channel = 0;     ///< among all pixels of the tile
  int phase = 0;       ///< column in the tile
  bool above = false;  ///< above the tile's measured row
};

/// L = ln(range in metres), on tiles that have one measured row each. A measured pixel without a
/// return is filled from above (at the top: 20 m) and marked as empty. The start is linear in
/// 1 / range by the beams' true elevations.
class LogRanges final : public Measurement {
 public:
  static constexpr float kTypicalRange_m = 20.0F;

  /// columns: of the image.
  LogRanges(const NetworkDescription& description, TileSize tile, int columns,
            const Engine& engine);

  void take(const RangeImage& measured_m) override;
  void start_row(int row, float* image_rows, Tensor& z0) override;
  const float* l_row(int channel, int row) const override;
  /// Nobody needs them as tiles.
  const Candidates& candidates() const override { return candidates_; }
  /// Measured pixels as they were measured, without what fills them.
  RangeImage in_metres(const Tensor& tiles) const override;
  void put_truth(const RangeImage& truth_m, Tensor& tiles) const override;

  const RangeImage& measured_m() const { return *measured_m_; }
  const std::vector<ComputedPixel>& computed() const { return computed_; }
  int rows() const { return log_.rows(); }        ///< of the tiles
  int columns() const { return log_.columns(); }  ///< of the tiles
  /// L of a column of the tiles.
  const float* log_row(int phase, int row) const { return log_.row(phase, row); }
  /// 1 where it was measured, 0 where it is filled.
  const float* valid_row(int phase, int row) const { return valid_.row(phase, row); }
  /// L in the measured row above or below a computed pixel of row `row`, clamped.
  const float* above(const ComputedPixel& pixel, int row) const {
    return log_.row(pixel.phase, row_above(pixel, row));
  }
  const float* below(const ComputedPixel& pixel, int row) const {
    return log_.row(pixel.phase, row_below(pixel, row));
  }

 private:
  int row_above(const ComputedPixel& pixel, int row) const;
  int row_below(const ComputedPixel& pixel, int row) const;

  RowSelection measured_rows_;
  TileSize tile_;
  const kernels::RowKernels& kernels_;
  std::vector<ComputedPixel> computed_;
  std::vector<float> weight_above_;  ///< of each image row between its measured neighbours
  Tensor log_;                       ///< tile columns x rows: one channel per column of a tile
  Tensor inverse_;                   ///< 1 / m
  Tensor valid_;
  const RangeImage* measured_m_ = nullptr;
  Candidates candidates_;
  std::vector<std::vector<float>> scratch_;  ///< three rows for each thread
};

}  // namespace hqslam::nn

#pragma once

#include <cmath>
#include <vector>

#include "graph/layer.h"
#include "hqslam/core/range_image.h"
#include "hqslam/nn/network.h"
#include "hqslam/nn/network_description.h"
#include "kernels/row_kernels.h"
#include "tensor.h"
#include "tiles.h"

namespace hqslam::nn {

/// The nearest measured range above each pixel and the nearest one below it. Tiles, as H.
struct Candidates {
  Tensor above;
  Tensor below;
};
/// The candidates of one row of a channel of the tiles, wherever they are stored.
struct CandidateRows {
  const float* above = nullptr;
  const float* below = nullptr;
};

/// M and W^2 / (W^2 + 1) in the pixels of one row of a channel of the tiles.
struct RecalledRow {
  const float* m = nullptr;  ///< null: nothing is recalled
  const float* share = nullptr;
};

/// L, what was measured, in the unit that the loop works in, and the start that is made of it.
class Measurement {
 public:
  virtual ~Measurement() = default;

  /// The scan must outlive the other calls. Called by all threads of a parallel region, they
  /// share the work and wait for each other at the end.
  virtual void take(const Observation& seen) = 0;
  /// One row of tiles of Z0 = Y0, by the calling thread alone. image_rows: scratch for as many rows
  /// of the image.
  virtual void start_row(int row, float* image_rows, Tensor& z0) = 0;
  /// L in the pixels of one row of a channel of the tiles; null: those are not measured.
  virtual const float* l_row(int channel, int row) const = 0;
  virtual RecalledRow recalled_row(int /*channel*/, int /*row*/) const { return {}; }
  virtual const Candidates& candidates() const = 0;

  /// Tiles in the loop's unit as an image in metres.
  virtual RangeImage in_metres(const Tensor& tiles) const = 0;
};

/// L = range / range_scale_m; the start is linear between the measured rows.
class ScaledRanges final : public Measurement {
 public:
  /// shape: a tensor of tiles, as H. starts_at_zero: Z0 = 0 instead.
  ScaledRanges(const NetworkDescription& description, TileSize tile, const Tensor& shape,
               bool starts_at_zero);

  void take(const Observation& seen) override;
  void start_row(int row, float* image_rows, Tensor& z0) override;
  const float* l_row(int channel, int row) const override;
  const Candidates& candidates() const override { return candidates_; }
  RangeImage in_metres(const Tensor& tiles) const override;

 private:
  RowSelection measured_rows_;
  float range_scale_m_;
  TileSize tile_;
  bool starts_at_zero_;
  const RangeImage* measured_m_ = nullptr;
  RangeImage scaled_;  ///< of the measured rows
  Candidates candidates_;
};

/// A pixel of a tile that is not measured.
struct ComputedPixel {
  int channel = 0;     ///< among all pixels of the tile
  int phase = 0;       ///< column in the tile
  bool above = false;  ///< above the tile's measured row
};

/// L = ln(range in metres), on tiles that have one measured row each. A measured pixel without a
/// return is filled from above (at the top: 20 m) and marked as empty. The start is linear in
/// 1 / range by the beams' true elevations. M, where it is recalled, is ln(range in metres) too.
class LogRanges final : public Measurement {
 public:
  static constexpr float kTypicalRange_m = 20.0F;
  inline static const float kTypicalLogRange = std::log(kTypicalRange_m);

  /// columns: of the image. recalls: M and W are taken too.
  LogRanges(const NetworkDescription& description, TileSize tile, int columns, bool recalls,
            const Engine& engine);

  void take(const Observation& seen) override;
  void start_row(int row, float* image_rows, Tensor& z0) override;
  const float* l_row(int channel, int row) const override;
  RecalledRow recalled_row(int channel, int row) const override;
  /// M minus the start, of a measured pixel minus L; 0 where nothing is recalled; null without a
  /// memory.
  const float* recalled_step_row(int channel, int row) const {
    return recalled_step_.channels() == 0 ? nullptr : recalled_step_.row(channel, row);
  }
  /// W^2 / (W^2 + 1); null without a memory.
  const float* recalled_share_row(int channel, int row) const {
    return recalled_share_.channels() == 0 ? nullptr : recalled_share_.row(channel, row);
  }
  /// Empty: the prior takes them row by row.
  const Candidates& candidates() const override { return candidates_; }
  /// Measured pixels as they were measured, without what fills them.
  RangeImage in_metres(const Tensor& tiles) const override;

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
  void take_recalled(const RecalledImage* recalled, int row);
  void put_recalled_step(int channel, int row, const float* start);
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
  Tensor recalled_log_;    ///< tiles of M, where there is a memory; 0 where nothing is recalled
  Tensor recalled_share_;  ///< tiles of W^2 / (W^2 + 1)
  Tensor recalled_step_;
  const RangeImage* measured_m_ = nullptr;
  Candidates candidates_;
  std::vector<std::vector<float>> scratch_;  ///< three rows for each thread
};

}  // namespace hqslam::nn

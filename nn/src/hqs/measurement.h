#pragma once

#include <vector>

#include "../tensor.h"
#include "../tiles.h"
#include "hqslam/core/range_image.h"
#include "hqslam/nn/network_description.h"

namespace hqslam::nn {

/// What a pixel may be, next to what it is now: the nearest measured range above it, the nearest
/// measured range below it. Tiles, as H.
struct Candidates {
  Tensor above;
  Tensor below;
};

/// L, what was measured, in the unit that the loop works in, and the start that is made of it.
class Measurement {
 public:
  virtual ~Measurement() = default;

  /// measured_m: the measured rows, metres, 0 = no return; must outlive what is asked of it. Called
  /// by all threads of a parallel region, they share the work and wait for each other at the end.
  virtual void take(const RangeImage& measured_m) = 0;
  /// One row of tiles of Z0 = Y0, by the calling thread alone. image_rows: scratch for as many rows
  /// of the image.
  virtual void start_row(int row, float* image_rows, Tensor& z0) = 0;
  /// L in the pixels of one row of a channel of the tiles; null: those are not measured.
  virtual const float* l_row(int channel, int row) const = 0;
  virtual const Candidates& candidates() const = 0;

  /// Tiles in the loop's unit as an image in metres.
  virtual RangeImage in_metres(const Tensor& tiles) const = 0;
  /// All true ranges (metres), as tiles in the unit that the loss takes.
  virtual void put_truth(const RangeImage& truth_m, Tensor& tiles) const = 0;
};

/// L = range / range_scale_m, and where it lies between measured rows their linear interpolation.
class ScaledRanges final : public Measurement {
 public:
  /// shape: a tensor of tiles, as H. starts_at_zero: Z0 = 0 instead.
  ScaledRanges(const NetworkDescription& description, TileSize tile, const Tensor& shape,
               bool starts_at_zero);

  void take(const RangeImage& measured_m) override;
  void start_row(int row, float* image_rows, Tensor& z0) override;
  const float* l_row(int channel, int row) const override;
  const Candidates& candidates() const override { return candidates_; }
  RangeImage in_metres(const Tensor& tiles) const override;
  void put_truth(const RangeImage& truth_m, Tensor& tiles) const override;

 private:
  RowSelection measured_rows_;
  float range_scale_m_;
  TileSize tile_;
  bool starts_at_zero_;
  const RangeImage* measured_m_ = nullptr;
  RangeImage scaled_;  ///< of the measured rows
  Candidates candidates_;
};

}  // namespace hqslam::nn

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hqslam/core/sensor_model.h"

namespace hqslam::nn {

struct OutlierRemovalOptions {
  /// Neighbouring pixels are connected if the angle between the longer beam and the line through
  /// both points is larger than this.
  double min_angle_rad = 0.17453292519943295;  // 10 degrees
  /// Components of fewer pixels are rejected.
  int min_pixels = 20;
  /// A pixel of such a component is kept if its range is within this share of a range that was
  /// measured in the next measured row above or below it, in its column or one beside it: a thin
  /// pole, the edge of a wall. 0: none is kept.
  float support_share = 0.0F;
};

/// Throws Error unless 0 < min_angle < pi/2, min_pixels >= 0 and 0 <= support_share < 1.
void validate(const OutlierRemovalOptions& options);

/// Q of eq. 10c: which pixels of a range image belong to small connected components. The
/// components are those that a breadth-first search over N4 neighbours finds (ComponentLabeler in
/// core, which the tests compare with), found here from runs of connected pixels in each row that
/// are merged with union-find: several times as fast. Differs from the paper by support_share.
class OutlierRemoval {
 public:
  /// `columns` may be fewer than the sensor's: a cut-out of a scan, closed to a circle. Throws
  /// Error unless the options are valid and 1 <= columns <= sensor.columns.
  OutlierRemoval(const SensorModel& sensor, RowSelection measured_rows,
                 const OutlierRemovalOptions& options, int columns);

  /// range_m: rows x columns, metres, row-major, 0 = no return. rejected: the same shape, 1 where
  /// the pixel is rejected, otherwise 0. Pixels of measured rows and pixels without a return are
  /// never rejected. Uses up to `threads` OpenMP threads; the result does not depend on their
  /// number. No call allocates.
  void find(const float* range_m, std::uint8_t* rejected, int threads = 1);

 private:
  /// A run of connected pixels in one row that is not known to belong to a large component.
  struct Run {
    std::int32_t parent = 0;
    std::int32_t pixels = 0;  ///< at a root: of the whole set of runs
    std::int32_t start = 0;   ///< index of the first pixel's bit
  };

  /// Rows are labelled in bands, each by one thread, that are joined afterwards.
  static constexpr int kMaxBands = 4;

  int first_row(int band) const;
  std::int32_t first_run_of(int band) const { return first_row(band) * columns_; }
  void label_band(const float* range_m, int band);
  void connect_row(const float* range_m, int row);
  void mark_large_rectangles(int first, int end, int height);
  void settle(int row);
  void spread(int from, int to);
  void number_runs(int band);
  void join_over_wrap(int row);
  void join_with_row_below(int row, std::int32_t* run_pairs);
  void keep_touching(int row, int other_row);
  void write_band(int band, std::uint8_t* rejected);
  void keep_supported(const float* range_m, int row, std::uint8_t* rejected_row) const;
  bool supported(const float* range_m, int row, int column) const;
  void write_row(int row, std::uint8_t* rejected_row);
  std::int32_t run_of(int row, int column) const;
  std::int32_t root_of(std::int32_t run);
  void join(std::int32_t a, std::int32_t b);
  std::size_t row_start(int row) const { return static_cast<std::size_t>(row) * words_; }

  int rows_;
  int columns_;
  int words_;  ///< 64-bit words per row of bits
  int min_pixels_;
  float support_share_;
  int bands_ = 1;
  RowSelection measured_rows_;
  float tan_min_angle_;
  float horizontal_sin_;
  float horizontal_cos_;
  std::vector<float> down_sin_;  ///< between row r and r + 1
  std::vector<float> down_cos_;
  // One bit per pixel, rows_ x words_.
  std::vector<std::uint64_t> present_;
  std::vector<std::uint64_t> right_;
  std::vector<std::uint64_t> down_;
  std::vector<std::uint64_t> large_;      ///< known to belong to a component that stays
  std::vector<std::uint64_t> undecided_;  ///< present and not known to be large: runs_
  std::vector<std::uint64_t> run_start_;  ///< first pixels of runs_
  std::vector<std::uint8_t> wraps_;       ///< per row: last column connected with the first
  std::vector<std::int32_t> first_run_;   ///< per word: the first run that starts in it or later
  std::vector<Run> runs_;                 ///< of band b: from first_run_of(b) to end_run_[b]
  std::array<std::int32_t, kMaxBands> end_run_{};
  std::vector<std::int32_t> run_pairs_;  ///< of two rows: numbers of connected runs; per band
};

}  // namespace hqslam::nn

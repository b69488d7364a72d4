#include "hqslam/nn/hqs/outlier_removal.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <numbers>

#include "hqslam/core/connected_components.h"
#include "hqslam/core/error.h"
#include "parameters.h"
#include "row_bits.h"

namespace hqslam::nn {

/// Purpose: which pixels belong to small components, without a visit to every pixel.
///
/// In: ranges (rows x columns, metres). Out: a mask of the pixels in components below min_pixels.
/// Method: bits mark which neighbours connect (row_bits.h). A run of connected pixels in a row, or
/// a rectangle, that has min_pixels by itself makes its component large; two sweeps over the rows
/// carry that on with a few operations per 64 pixels and decide most of an image. Only the runs
/// that are left are numbered and joined by union-find; those that touch a large component, by a
/// way that no sweep took, are large too. Which pixels the sweeps reach never changes the result.
/// Source: the criterion is ComponentLabeler's (Bogoslavskyi & Stachniss, IROS 2016).

void validate(const OutlierRemovalOptions& options) {
  const char* const what = "outlier removal";
  check_that(options.min_angle_rad > 0.0 && options.min_angle_rad < std::numbers::pi / 2.0, what,
             "min_angle_rad", options.min_angle_rad, "0 < angle < pi/2");
  check_that(options.min_pixels >= 0, what, "min_pixels", options.min_pixels, "0 or more");
  check_that(options.support_share >= 0.0F && options.support_share < 1.0F, what, "support_share",
             options.support_share, "0 to below 1");
}

namespace {

void validate(const SensorModel& sensor, RowSelection measured_rows,
              const OutlierRemovalOptions& options, int columns) {
  nn::validate(options);
  if (columns < 1 || columns > sensor.columns) {
    throw Error("outlier removal: columns is {}, expected 1 to {}, the sensor's", columns,
                sensor.columns);
  }
  if (measured_rows.offset < 0 || measured_rows.stride < 1) {
    throw Error(
        "outlier removal: measured rows are {}, {} + {}, ..., expected an offset of 0 or more and "
        "a stride of 1 or more",
        measured_rows.offset, measured_rows.offset, measured_rows.stride);
  }
}

template <typename Visit>
void for_each_bit(std::uint64_t word, int first_column, const Visit& visit) {
  for (; word != 0; word &= word - 1) visit(first_column + std::countr_zero(word));
}

/// The length of the run that starts at this bit of the first word.
int run_pixels(const std::uint64_t* right, int bit) {
  int pixels = 1 + std::countr_one(*right >> bit);
  for (int end = kWordBits; bit + pixels > end; end += kWordBits) {
    pixels += std::countr_one(*++right);
  }
  return pixels;
}

}  // namespace

OutlierRemoval::OutlierRemoval(const SensorModel& sensor, RowSelection measured_rows,
                               const OutlierRemovalOptions& options, int columns)
    : rows_(sensor.rows()),
      columns_(columns),
      words_(words_for(columns)),
      min_pixels_(options.min_pixels),
      support_share_(options.support_share),
      measured_rows_(measured_rows) {
  validate(sensor, measured_rows, options, columns);
  tan_min_angle_ = static_cast<float>(std::tan(options.min_angle_rad));
  horizontal_sin_ = static_cast<float>(std::sin(sensor.column_step_rad()));
  horizontal_cos_ = static_cast<float>(std::cos(sensor.column_step_rad()));
  for (int row = 0; row + 1 < rows_; ++row) {
    const double alpha_rad = sensor.beam_elevation_rad[row] - sensor.beam_elevation_rad[row + 1];
    down_sin_.push_back(static_cast<float>(std::sin(alpha_rad)));
    down_cos_.push_back(static_cast<float>(std::cos(alpha_rad)));
  }
  const std::size_t words = row_start(rows_);
  for (auto* bits : {&present_, &right_, &down_, &large_, &undecided_, &run_start_})
    bits->resize(words);
  wraps_.resize(rows_);
  first_run_.resize(words);
  runs_.resize(static_cast<std::size_t>(rows_) * columns_);
  run_pairs_.resize(2 * static_cast<std::size_t>(columns_) * kMaxBands);
}

int OutlierRemoval::first_row(int band) const { return rows_ * band / bands_; }

void OutlierRemoval::find(const float* range_m, std::uint8_t* rejected, int threads) {
  // One band is fastest on one thread; more than threads share the load of unlike bands.
  bands_ = threads > 1 ? kMaxBands : 1;
#pragma omp parallel for schedule(dynamic) num_threads(threads) if (threads > 1)
  for (int band = 0; band < bands_; ++band) label_band(range_m, band);
  for (int band = 1; band < bands_; ++band) {
    if (first_row(band) > 0) join_with_row_below(first_row(band) - 1, run_pairs_.data());
  }
#pragma omp parallel for schedule(dynamic) num_threads(threads) if (threads > 1)
  for (int band = 0; band < bands_; ++band) write_band(band, rejected);
  if (support_share_ <= 0.0F) return;
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1)
  for (int row = 0; row < rows_; ++row) {
    keep_supported(range_m, row, rejected + static_cast<std::size_t>(row) * columns_);
  }
}

void OutlierRemoval::keep_supported(const float* range_m, int row,
                                    std::uint8_t* rejected_row) const {
  for (int column = 0; column < columns_; ++column) {
    if (rejected_row[column] != 0 && supported(range_m, row, column)) rejected_row[column] = 0;
  }
}

bool OutlierRemoval::supported(const float* range_m, int row, int column) const {
  const int stride = measured_rows_.stride;
  const int above = row < measured_rows_.offset ? -1 : row - (row - measured_rows_.offset) % stride;
  const int below = above < 0 ? measured_rows_.offset : above + stride;
  const float pixel_m = range_m[static_cast<std::size_t>(row) * columns_ + column];
  for (const int measured : {above, below}) {
    if (measured < 0 || measured >= rows_) continue;
    const float* row_m = range_m + static_cast<std::size_t>(measured) * columns_;
    for (const int step : {columns_ - 1, 0, 1}) {
      const float measured_m = row_m[(column + step) % columns_];
      if (std::abs(pixel_m - measured_m) < support_share_ * measured_m) return true;
    }
  }
  return false;
}

/// Everything that needs only the rows of one band.
void OutlierRemoval::label_band(const float* range_m, int band) {
  const int first = first_row(band);
  const int end = first_row(band + 1);
  for (int row = first; row < end; ++row) connect_row(range_m, row);
  for (const int height : {2, 4}) mark_large_rectangles(first, end, height);
  for (int row = first; row < end; ++row) settle(row);
  for (int row = first + 1; row < end; ++row) spread(row - 1, row);
  for (int row = end - 2; row >= first; --row) spread(row + 1, row);
  number_runs(band);
  std::int32_t* run_pairs = &run_pairs_[2 * static_cast<std::size_t>(columns_) * band];
  for (int row = first; row < end; ++row) {
    join_over_wrap(row);
    if (row + 1 < end) join_with_row_below(row, run_pairs);
  }
}

/// The bits of a row, and in large_ a pixel of each run that is long enough by itself.
void OutlierRemoval::connect_row(const float* range_m, int row) {
  const float* row_m = range_m + static_cast<std::size_t>(row) * columns_;
  const bool has_below = row + 1 < rows_;
  const ConnectionAngles angles{horizontal_sin_, horizontal_cos_, has_below ? down_sin_[row] : 0.0F,
                                has_below ? down_cos_[row] : 1.0F, tan_min_angle_};
  const std::size_t start = row_start(row);
  find_connections(row_m, has_below ? row_m + columns_ : row_m, columns_, angles,
                   {&present_[start], &right_[start], &down_[start]});
  const float first_m = row_m[0];
  const float last_m = row_m[columns_ - 1];
  wraps_[row] = first_m > 0.0F && last_m > 0.0F &&
                ComponentLabeler::connected(first_m, last_m, horizontal_sin_, horizontal_cos_,
                                            tan_min_angle_);
  mark_long_runs(&right_[start], words_, min_pixels_, &large_[start]);
}

/// Adds to large_ the first pixel of every rectangle of `height` rows, connected in each row and
/// at its left side, that is large by itself. run_start_ serves as scratch.
void OutlierRemoval::mark_large_rectangles(int first, int end, int height) {
  const int width = (min_pixels_ - 1) / height + 1;
  for (int row = first; row < end; ++row) {
    mark_long_runs(&right_[row_start(row)], words_, width, &run_start_[row_start(row)]);
  }
  for (std::size_t i = row_start(first); i + row_start(height - 1) < row_start(end); ++i) {
    std::uint64_t marked = run_start_[i];
    for (int below = 1; below < height; ++below) {
      const std::size_t j = i + row_start(below);
      marked &= run_start_[j] & down_[j - words_];
    }
    large_[i] |= marked;
  }
}

/// Marks the runs whole that have a pixel in large_, over the wrap too.
void OutlierRemoval::settle(int row) {
  const std::uint64_t* right = &right_[row_start(row)];
  std::uint64_t* large = &large_[row_start(row)];
  fill_runs(right, words_, large);
  if (wraps_[row] == 0) return;
  std::uint64_t& last_word = large[words_ - 1];
  const int last_bit = (columns_ - 1) % kWordBits;
  const std::uint64_t first = large[0] & 1;
  const std::uint64_t last = last_word >> last_bit & 1;
  if (first == last) return;
  large[0] |= 1;
  last_word |= std::uint64_t{1} << last_bit;
  fill_runs(right, words_, large);
}

/// Takes large_ from one row over to a neighbouring one.
void OutlierRemoval::spread(int from, int to) {
  const std::uint64_t* source = &large_[row_start(from)];
  const std::uint64_t* vertical = &down_[row_start(std::min(from, to))];
  const std::uint64_t* present = &present_[row_start(to)];
  std::uint64_t* target = &large_[row_start(to)];
  std::uint64_t added = 0;
  for (int word = 0; word < words_; ++word) {
    const std::uint64_t reached = source[word] & vertical[word] & present[word] & ~target[word];
    target[word] |= reached;
    added |= reached;
  }
  if (added != 0) settle(to);
}

/// large_ has whole runs, so what is left has whole runs too.
void OutlierRemoval::number_runs(int band) {
  std::int32_t count = first_run_of(band);
  for (int row = first_row(band); row < first_row(band + 1); ++row) {
    std::uint64_t joins_previous = 0;  // in bit 0
    for (std::size_t i = row_start(row); i < row_start(row + 1); ++i) {
      undecided_[i] = present_[i] & ~large_[i];
      run_start_[i] = undecided_[i] & ~(right_[i] << 1 | joins_previous);
      joins_previous = right_[i] >> 63;
      first_run_[i] = count;
      for_each_bit(run_start_[i], 0, [&](int bit) {
        const auto start = static_cast<std::int32_t>(i) * kWordBits + bit;
        runs_[count] = {count, run_pixels(&right_[i], bit), start};
        ++count;
      });
    }
  }
  end_run_[band] = count;
}

void OutlierRemoval::join_over_wrap(int row) {
  const std::uint64_t last_word = undecided_[row_start(row + 1) - 1];
  if (wraps_[row] != 0 && (last_word >> (columns_ - 1) % kWordBits & 1) != 0) {
    join(run_of(row, 0), run_of(row, columns_ - 1));
  }
}

void OutlierRemoval::join_with_row_below(int row, std::int32_t* run_pairs) {
  const auto runs = [&](std::size_t start) {
    return RunRow{&undecided_[start], &run_start_[start], &first_run_[start]};
  };
  const std::size_t start = row_start(row);
  const int numbers =
      list_run_pairs(&down_[start], runs(start), runs(start + words_), words_, run_pairs);
  for (int i = 0; i < numbers; i += 2) join(run_pairs[i], run_pairs[i + 1]);
  keep_touching(row, row + 1);
  keep_touching(row + 1, row);
}

/// Makes the runs of a row count as large that touch a large component in the other row.
void OutlierRemoval::keep_touching(int row, int other_row) {
  for (int word = 0; word < words_; ++word) {
    const std::uint64_t touching = undecided_[row_start(row) + word] &
                                   large_[row_start(other_row) + word] &
                                   down_[row_start(std::min(row, other_row)) + word];
    for_each_bit(touching, word * kWordBits,
                 [&](int column) { runs_[root_of(run_of(row, column))].pixels = min_pixels_; });
  }
}

/// Adds to large_ the first pixel of every run whose component turned out to be large, and from
/// it the whole run.
void OutlierRemoval::write_band(int band, std::uint8_t* rejected) {
  for (std::int32_t run = first_run_of(band); run < end_run_[band]; ++run) {
    // No short cuts are made on the way: another band's parents may be read by its own thread.
    std::int32_t root = runs_[run].parent;
    while (runs_[root].parent != root) root = runs_[root].parent;
    const std::uint64_t large = runs_[root].pixels >= min_pixels_;
    large_[runs_[run].start / kWordBits] |= large << runs_[run].start % kWordBits;
  }
  for (int row = first_row(band); row < first_row(band + 1); ++row) {
    write_row(row, rejected + static_cast<std::size_t>(row) * columns_);
  }
}

void OutlierRemoval::write_row(int row, std::uint8_t* rejected_row) {
  const int beyond = row - measured_rows_.offset;
  if (beyond >= 0 && beyond % measured_rows_.stride == 0) {
    std::memset(rejected_row, 0, static_cast<std::size_t>(columns_));
    return;
  }
  const std::size_t start = row_start(row);
  fill_runs(&right_[start], words_, &large_[start]);
  for (std::size_t i = start; i < start + words_; ++i) undecided_[i] = present_[i] & ~large_[i];
  unpack(&undecided_[start], columns_, rejected_row);
}

std::int32_t OutlierRemoval::run_of(int row, int column) const {
  const std::size_t i = row_start(row) + column / kWordBits;
  const std::uint64_t up_to_column = (std::uint64_t{2} << column % kWordBits) - 1;
  return first_run_[i] + std::popcount(run_start_[i] & up_to_column) - 1;
}

std::int32_t OutlierRemoval::root_of(std::int32_t run) {
  while (runs_[run].parent != run) {
    runs_[run].parent = runs_[runs_[run].parent].parent;
    run = runs_[run].parent;
  }
  return run;
}

void OutlierRemoval::join(std::int32_t a, std::int32_t b) {
  a = root_of(a);
  b = root_of(b);
  if (a == b) return;
  runs_[std::max(a, b)].parent = std::min(a, b);
  runs_[std::min(a, b)].pixels += runs_[std::max(a, b)].pixels;
}

}  // namespace hqslam::nn

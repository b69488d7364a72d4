#pragma once

#include <cstdint>

namespace hqslam::nn {

// One row of an image with one bit per pixel: bit c % 64 of word c / 64 belongs to column c. Bits
// beyond the last column are zero.

inline constexpr int kWordBits = 64;
inline int words_for(int columns) { return (columns + kWordBits - 1) / kWordBits; }

/// The criterion's constants for a row: float, as ComponentLabeler rounds them.
struct ConnectionAngles {
  float horizontal_sin = 0.0F;
  float horizontal_cos = 1.0F;
  float down_sin = 0.0F;  ///< between this row's beam and that of the row below
  float down_cos = 1.0F;
  float tan_min_angle = 0.0F;
};

/// The bits of one row, words_for(columns) words each. `right`: the pixel is connected with the
/// one to its right (never set in the last column); `down`: with the one below,
/// provided that both are present.
struct ConnectionRow {
  std::uint64_t* present;
  std::uint64_t* right;
  std::uint64_t* down;
};

/// row_m and below_m: `columns` ranges in metres, 0 = no return. The last row passes itself as
/// below_m and ignores `down`.
void find_connections(const float* row_m, const float* below_m, int columns,
                      const ConnectionAngles& angles, const ConnectionRow& result);

/// Sets in `marked` at least one bit of every run of two or more `right`-connected pixels that is
/// at least min_pixels long, and no other.
void mark_long_runs(const std::uint64_t* right, int words, int min_pixels, std::uint64_t* marked);

/// Marks every run whole that has a marked pixel.
void fill_runs(const std::uint64_t* right, int words, std::uint64_t* marked);

/// Numbered runs of one row, words_for(columns) words each.
struct RunRow {
  const std::uint64_t* pixels;    ///< those that belong to a run
  const std::uint64_t* start;     ///< the first pixel of each run
  const std::int32_t* first_run;  ///< number of the first run that starts in this word or later
};

/// Lists the runs of two rows that a bit of `down` connects, from left to right, as the upper
/// run's number and the lower's; a pair may come more than once. `pairs` has room for two numbers
/// per column. Returns how many numbers were written.
int list_run_pairs(const std::uint64_t* down, const RunRow& upper, const RunRow& lower, int words,
                   std::int32_t* pairs);

/// One byte, 0 or 1, for each of the first `columns` bits.
void unpack(const std::uint64_t* bits, int columns, std::uint8_t* bytes);

}  // namespace hqslam::nn

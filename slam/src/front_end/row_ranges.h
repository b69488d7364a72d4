#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <vector>

namespace hqslam::slam {

/// The sequence of returns along a row from which features are chosen.
struct RowRanges {
  static constexpr int kHalfWindow = 5;  ///< neighbours on each side

  std::vector<float> range_m;
  std::vector<int> column;

  int size() const { return static_cast<int>(range_m.size()); }
  bool neighbours(int i, int j, int max_gap) const {
    return std::abs(column[i] - column[j]) <= max_gap;
  }

  /// |sum of the 10 neighbours' ranges - 10 range| for a point with five on each side.
  float smoothness_at_m(int i) const {
    float sum_m = -2.0F * kHalfWindow * range_m[i];
    for (int k = 1; k <= kHalfWindow; ++k) sum_m += range_m[i - k] + range_m[i + k];
    return std::abs(sum_m);
  }

  /// Marks the far side of depth jumps, between columns that are max_gap apart at most, and
  /// surfaces along the beam.
  void mark_unreliable(int max_gap, std::vector<std::uint8_t>& unusable) const {
    constexpr float kDepthJump_m = 0.3F;    // occludes what is behind
    constexpr float kParallelJump = 0.02F;  // share of the range, on both sides: along the beam
    for (int i = kHalfWindow; i + kHalfWindow + 1 < size(); ++i) {
      const float here_m = range_m[i];
      const float next_m = range_m[i + 1];
      if (neighbours(i, i + 1, max_gap)) {
        if (here_m - next_m > kDepthJump_m) {
          std::fill(unusable.begin() + i - kHalfWindow, unusable.begin() + i + 1, 1);
        } else if (next_m - here_m > kDepthJump_m) {
          std::fill(unusable.begin() + i + 1, unusable.begin() + i + kHalfWindow + 2, 1);
        }
      }
      const float before_m = range_m[i - 1];
      if (std::abs(before_m - here_m) > kParallelJump * here_m &&
          std::abs(next_m - here_m) > kParallelJump * here_m) {
        unusable[i] = 1;
      }
    }
  }

  /// Excludes the neighbours of a chosen point, up to the next gap.
  void suppress_neighbours(int chosen, std::vector<std::uint8_t>& taken) const {
    constexpr int kMaxGap = 10;  // neighbours farther apart than this are none
    taken[chosen] = 1;
    for (const int direction : {-1, 1}) {
      for (int k = 1; k <= kHalfWindow; ++k) {
        const int i = chosen + direction * k;
        if (i < 0 || i >= size() || !neighbours(i, i - direction, kMaxGap)) break;
        taken[i] = 1;
      }
    }
  }
};

}  // namespace hqslam::slam

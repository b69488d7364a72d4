// Compiled once per instruction set. One pass keeps kChannelBlock channels times kColumnVectors
// vectors of outputs in registers, or kGradientChannels channels times kGradientTaps taps of
// gradients. Everything lives in an unnamed namespace: no two of the translation units may share a
// function.

#include <utility>

#include "row_kernels.h"
#include "vector_math_inl.h"

namespace hqslam::nn::kernels {
namespace {

/// a(y + skip) as AccumulateRow has it. accumulate_block spells it out: with a call GCC keeps fewer
/// sums in registers, a fifth slower without AVX.
inline Vector ended(Vector y, const float* skip, const float* activated, float negative_slope) {
  if (skip != nullptr) y += load(skip);
  const Vector negative = negative_slope * y;
  if (activated != nullptr) return load(activated) > 0.0F ? y : negative;
  return y > negative ? y : negative;
}

/// kChannelBlock channels from `channel` on, `kVectors` vectors from column x on.
template <int kVectors>
inline void accumulate_block(const AccumulateRow& row, int channel, int x) {
  constexpr int kParts = kOutputBlock / kChannelBlock;
  static_assert(kParts * kChannelBlock == kOutputBlock);
  Vector sum[kChannelBlock][kVectors];
#pragma GCC unroll 16
  for (int o = 0; o < kChannelBlock; ++o) {
    const float start = row.bias == nullptr ? 0.0F : row.bias[channel + o];
#pragma GCC unroll 16
    for (int v = 0; v < kVectors; ++v) sum[o][v] = Vector{} + start;
  }
  const float* weights =
      row.weights + static_cast<std::int64_t>(channel / kOutputBlock) * row.taps * kOutputBlock +
      channel % kOutputBlock;
  const float* input = row.input + x;
  for (int t = 0; t < row.taps; ++t) {
    // Prefetches the next block: where all weights are more than the second-level cache holds, a
    // quarter of the time would be waiting for them.
    __builtin_prefetch(weights + (t + row.taps) * kOutputBlock);
    const float* values = input + row.tap_offset[t];
    Vector in[kVectors];
#pragma GCC unroll 16
    for (int v = 0; v < kVectors; ++v) in[v] = load(values + v * kVectorFloats);
#pragma GCC unroll 16
    for (int o = 0; o < kChannelBlock; ++o) {
      const float weight = weights[t * kOutputBlock + o];
#pragma GCC unroll 16
      for (int v = 0; v < kVectors; ++v) sum[o][v] += weight * in[v];
    }
  }
  const int channels = row.output_channels - channel;
#pragma GCC unroll 16
  for (int o = 0; o < kChannelBlock; ++o) {
    if (o >= channels) break;
    float* output = row.output + (channel + o) * row.output_channel_stride + x;
    const float* skip =
        row.skip == nullptr ? nullptr : row.skip + (channel + o) * row.skip_channel_stride + x;
    const float* activated = row.activated == nullptr
                                 ? nullptr
                                 : row.activated + (channel + o) * row.activated_channel_stride + x;
#pragma GCC unroll 16
    for (int v = 0; v < kVectors; ++v) {
      Vector y = sum[o][v];
      if (skip != nullptr) y += load(skip + v * kVectorFloats);
      const Vector negative = row.negative_slope * y;
      if (activated != nullptr) {
        y = load(activated + v * kVectorFloats) > 0.0F ? y : negative;
      } else {
        y = y > negative ? y : negative;
      }
      store(output + v * kVectorFloats, y);
    }
  }
}

template <int kVectors>
inline void accumulate_columns(const AccumulateRow& row, int x) {
  for (int channel = 0; channel < row.output_channels; channel += kChannelBlock) {
    accumulate_block<kVectors>(row, channel, x);
  }
}

void accumulate(const AccumulateRow& row) {
  int x = row.begin;
  for (; x + (kColumnVectors - 1) * kVectorFloats < row.end; x += kColumnVectors * kVectorFloats) {
    accumulate_columns<kColumnVectors>(row, x);
  }
  for (; x + kVectorFloats < row.end; x += 2 * kVectorFloats) accumulate_columns<2>(row, x);
  for (; x < row.end; x += kVectorFloats) accumulate_columns<1>(row, x);
}

/// The vector itself, kept in a register. The compiler would otherwise read a value that is used
/// kTaps times as often from memory, which costs half of the speed.
inline Vector in_register(Vector vector) {
#if defined(__x86_64__)
  asm("" : "+v"(vector));
#elif defined(__aarch64__)
  asm("" : "+w"(vector));
#endif
  return vector;
}

/// The lane that lane i of with_halved_groups takes: the first (or second) half of every group of
/// kGroup lanes, those of the first vector before those of the second.
template <int kGroup, bool kSecond>
constexpr int half_group_lane(int i) {
  constexpr int kHalf = kGroup / 2;
  return i / kHalf * kGroup + i % kHalf + (kSecond ? kHalf : 0);
}

/// Two vectors of groups of kGroup lanes -> one of groups of half as many with the same sums.
template <int kGroup, int... kLanes>
inline Vector with_halved_groups(Vector a, Vector b, std::integer_sequence<int, kLanes...>) {
  return __builtin_shufflevector(a, b, half_group_lane<kGroup, false>(kLanes)...) +
         __builtin_shufflevector(a, b, half_group_lane<kGroup, true>(kLanes)...);
}

/// The sums over the lanes of kVectors vectors (a power of two) side by side in the first lanes.
template <int kVectors, int kGroup = kVectorFloats>
inline Vector sums_of_lanes(const Vector* vectors) {
  if constexpr (kGroup == 1) {
    return vectors[0];
  } else {
    constexpr int kHalf = kVectors == 1 ? 1 : kVectors / 2;
    Vector halved[kHalf];
#pragma GCC unroll 16
    for (int i = 0; i < kHalf; ++i) {
      halved[i] =
          with_halved_groups<kGroup>(vectors[2 * i % kVectors], vectors[(2 * i + 1) % kVectors],
                                     std::make_integer_sequence<int, kVectorFloats>{});
    }
    return sums_of_lanes<kHalf, kGroup / 2>(halved);
  }
}

/// Adds the first kGradientChannels lanes to as many floats.
inline void add_first_lanes(Vector vector, float* values) {
  typedef float Lanes
      __attribute__((vector_size(kGradientChannels * sizeof(float)), aligned(4), may_alias));
  Lanes lanes;
  __builtin_memcpy(&lanes, &vector, sizeof lanes);
  Lanes& to = *reinterpret_cast<Lanes*>(values);
  to = to + lanes;
}

/// The sums of kGradientChannels narrow channels, which begin at row 0 of `narrow`, for kTaps taps.
/// `gradient`: of the first tap, `padded_channels` floats before the next one's.
template <int kTaps>
inline void correlate_block(const CorrelateRows& rows, const float* const* narrow_channels,
                            const std::int64_t* tap_offset, int padded_channels, float* gradient) {
  Vector sum[kTaps][kGradientChannels];
#pragma GCC unroll 16
  for (int t = 0; t < kTaps; ++t) {
#pragma GCC unroll 16
    for (int a = 0; a < kGradientChannels; ++a) sum[t][a] = Vector{};
  }
  const auto add = [&](std::int64_t narrow, std::int64_t wide, auto&& load_narrow) {
    Vector in[kTaps];
#pragma GCC unroll 16
    for (int t = 0; t < kTaps; ++t) in[t] = load(rows.wide + tap_offset[t] + wide);
#pragma GCC unroll 16
    for (int a = 0; a < kGradientChannels; ++a) {
      const Vector value = in_register(load_narrow(narrow_channels[a] + narrow));
#pragma GCC unroll 16
      for (int t = 0; t < kTaps; ++t) sum[t][a] += value * in[t];
    }
  };
  const int whole = rows.columns - rows.columns % kVectorFloats;
  for (int y = 0; y < rows.rows; ++y) {
    const std::int64_t narrow = y * rows.narrow_row_stride;
    const std::int64_t wide = y * rows.wide_row_stride;
    for (int x = 0; x < whole; x += kVectorFloats) add(narrow + x, wide + x, load);
  }
  if (whole < rows.columns) {
    Vector inside{};  // 1 in the lanes of the last columns
    for (int i = 0; i < rows.columns - whole; ++i) inside[i] = 1.0F;
    for (int y = 0; y < rows.rows; ++y) {
      add(y * rows.narrow_row_stride + whole, y * rows.wide_row_stride + whole,
          [&](const float* values) { return inside > 0.0F ? load(values) : Vector{}; });
    }
  }
#pragma GCC unroll 16
  for (int t = 0; t < kTaps; ++t) {
    add_first_lanes(sums_of_lanes<kGradientChannels>(sum[t]), gradient + t * padded_channels);
  }
}

void correlate(const CorrelateRows& rows) {
  static_assert(kGradientBlock % kGradientChannels == 0);  // the last block fits the padding
  const int padded = whole_blocks(rows.narrow_channels);
  for (int channel = 0; channel < padded; channel += kGradientChannels) {
    // Channels beyond the last one repeat it; their sums go into the padding.
    const float* narrow[kGradientChannels];
    for (int a = 0; a < kGradientChannels; ++a) {
      const int here = channel + a < rows.narrow_channels ? channel + a : rows.narrow_channels - 1;
      narrow[a] = rows.narrow + here * rows.narrow_channel_stride;
    }
    float* gradient = rows.gradient + channel;
    int tap = 0;
    for (; tap + kGradientTaps <= rows.taps; tap += kGradientTaps) {
      correlate_block<kGradientTaps>(rows, narrow, rows.tap_offset + tap, padded,
                                     gradient + static_cast<std::int64_t>(tap) * padded);
    }
    if (kGradientTaps > 2 && tap + 2 <= rows.taps) {
      correlate_block<2>(rows, narrow, rows.tap_offset + tap, padded,
                         gradient + static_cast<std::int64_t>(tap) * padded);
      tap += 2;
    }
    for (; tap < rows.taps; ++tap) {
      correlate_block<1>(rows, narrow, rows.tap_offset + tap, padded,
                         gradient + static_cast<std::int64_t>(tap) * padded);
    }
  }
}

void split(const SplitRow& row) {
  for (int x = 0; x < row.columns; x += kVectorFloats) {
    const Vector first = load(row.input + 2 * x);
    const Vector second = load(row.input + 2 * x + kVectorFloats);
    store(row.even + x, every_second<0>(first, second));
    store(row.odd + x, every_second<1>(first, second));
  }
}

void merge(const MergeRow& row) {
  const auto put = [&](int column, Vector y) {
    store(row.output + column,
          ended(y, row.skip == nullptr ? nullptr : row.skip + column,
                row.activated == nullptr ? nullptr : row.activated + column, row.negative_slope));
  };
  for (int x = 0; x < row.columns; x += kVectorFloats) {
    const Vector even = load(row.even + x);
    const Vector odd = load(row.odd + x);
    put(2 * x, alternating<0>(even, odd));
    put(2 * x + kVectorFloats, alternating<kVectorFloats / 2>(even, odd));
  }
}

void select(const SelectRow& row) {
  for (int x = 0; x < row.columns; x += kVectorFloats) {
    const auto group = [&](int number) { return row.scores + number * row.group_stride + x; };
    Vector above = row.gain * load(group(0));
    Vector below = row.gain * load(group(1));
    Vector here = row.gain * load(group(2));
    Vector nothing = row.gain * load(group(3));
    const Vector largest = larger(larger(above, below), larger(here, nothing));
    above = exponential(above - largest);
    below = exponential(below - largest);
    here = exponential(here - largest);
    nothing = exponential(nothing - largest);
    const Vector scale = 1.0F / (above + below + here + nothing);
    above *= scale;
    below *= scale;
    here *= scale;
    store(group(0), above);
    store(group(1), below);
    store(group(2), here);
    store(group(3), nothing * scale);
    store(row.z + x, above * load(row.above + x) + below * load(row.below + x) +
                         here * load(row.here + x) + load(group(4)));
  }
}

void select_gradient(const SelectGradientRow& row) {
  for (int x = 0; x < row.columns; x += kVectorFloats) {
    const auto weight = [&](int group) {
      return load(row.weights + group * row.weight_stride + x);
    };
    const auto put = [&](int group, Vector d_score) {
      store(row.d_scores + group * row.d_score_stride + x, d_score);
    };
    const Vector d_z = load(row.d_z + x);
    const Vector above = load(row.above + x);
    const Vector below = load(row.below + x);
    const Vector here = load(row.here + x);
    const Vector mean = weight(0) * above + weight(1) * below + weight(2) * here;
    // d softmax_i / d score_j = gain w_i (delta_ij - w_j)
    const Vector scaled = row.gain * d_z;
    put(0, scaled * weight(0) * (above - mean));
    put(1, scaled * weight(1) * (below - mean));
    put(2, scaled * weight(2) * (here - mean));
    put(3, -scaled * weight(3) * mean);
    put(4, d_z);
    store(row.d_here + x, d_z * weight(2));
  }
}

}  // namespace
}  // namespace hqslam::nn::kernels

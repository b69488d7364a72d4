// Included by one translation unit per instruction set, which defines how wide a vector is
// (kVectorFloats) and how many outputs one pass keeps in registers (kChannelBlock channels times
// kColumnVectors vectors). Everything lives in an unnamed namespace: no two of the translation
// units may share a function.

#include "row_kernels.h"
#include "vector_math_inl.h"

namespace hqslam::nn::kernels {
namespace {

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
#pragma GCC unroll 16
    for (int v = 0; v < kVectors; ++v) {
      Vector y = sum[o][v];
      if (skip != nullptr) y += load(skip + v * kVectorFloats);
      const Vector negative = row.negative_slope * y;
      store(output + v * kVectorFloats, y > negative ? y : negative);
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

/// kTaps taps from `tap` on, `kVectors` vectors of narrow channels from `channel` on.
template <int kTaps, int kVectors>
inline void correlate_block(const CorrelateRow& row, int tap, int channel) {
  Vector sum[kTaps][kVectors];
#pragma GCC unroll 16
  for (int t = 0; t < kTaps; ++t) {
#pragma GCC unroll 16
    for (int v = 0; v < kVectors; ++v) sum[t][v] = Vector{};
  }
  const float* wide[kTaps];
#pragma GCC unroll 16
  for (int t = 0; t < kTaps; ++t) wide[t] = row.wide + row.tap_offset[tap + t];
  const float* narrow = row.narrow + channel;
  for (int x = 0; x < row.columns; ++x, narrow += row.narrow_channels) {
    Vector in[kVectors];
#pragma GCC unroll 16
    for (int v = 0; v < kVectors; ++v) in[v] = load(narrow + v * kVectorFloats);
#pragma GCC unroll 16
    for (int t = 0; t < kTaps; ++t) {
      const float value = wide[t][x];
#pragma GCC unroll 16
      for (int v = 0; v < kVectors; ++v) sum[t][v] += value * in[v];
    }
  }
#pragma GCC unroll 16
  for (int t = 0; t < kTaps; ++t) {
    float* gradient = row.gradient + (tap + t) * row.narrow_channels + channel;
#pragma GCC unroll 16
    for (int v = 0; v < kVectors; ++v) {
      store(gradient + v * kVectorFloats, load(gradient + v * kVectorFloats) + sum[t][v]);
    }
  }
}

template <int kVectors>
inline void correlate_channels(const CorrelateRow& row, int channel) {
  int tap = 0;
  for (; tap + kTapBlock <= row.taps; tap += kTapBlock) {
    correlate_block<kTapBlock, kVectors>(row, tap, channel);
  }
  for (; tap < row.taps; ++tap) correlate_block<1, kVectors>(row, tap, channel);
}

void correlate(const CorrelateRow& row) {
  int channel = 0;
  for (; channel + 2 * kVectorFloats <= row.narrow_channels; channel += 2 * kVectorFloats) {
    correlate_channels<2>(row, channel);
  }
  for (; channel < row.narrow_channels; channel += kVectorFloats) {
    correlate_channels<1>(row, channel);
  }
}

void select(const SelectRow& row) {
  for (int x = 0; x < row.columns; x += kVectorFloats) {
    Vector above = row.gain * load(row.score_above + x);
    Vector below = row.gain * load(row.score_below + x);
    Vector here = row.gain * load(row.score_here + x);
    Vector nothing = row.gain * load(row.score_nothing + x);
    const Vector largest = larger(larger(above, below), larger(here, nothing));
    above = exponential(above - largest);
    below = exponential(below - largest);
    here = exponential(here - largest);
    nothing = exponential(nothing - largest);
    const Vector scale = 1.0F / (above + below + here + nothing);
    above *= scale;
    below *= scale;
    here *= scale;
    store(row.score_above + x, above);
    store(row.score_below + x, below);
    store(row.score_here + x, here);
    store(row.score_nothing + x, nothing * scale);
    store(row.z + x, above * load(row.above + x) + below * load(row.below + x) +
                         here * load(row.here + x) + load(row.residual + x));
  }
}

/// As many chains as fit the narrower sets' 16 registers beside the two constants.
constexpr int kChains = 14;
constexpr int kChainMultiplyAdds = kChains * kVectorFloats;

float multiply_add_chains(std::int64_t rounds, float start) {
  const Vector factor = Vector{} + (0.9999F + start * 1e-9F);
  const Vector term = Vector{} + (1e-4F + start * 1e-9F);
  Vector chain[kChains];
#pragma GCC unroll 16
  for (int c = 0; c < kChains; ++c) chain[c] = Vector{} + (start + static_cast<float>(c));
  for (std::int64_t round = 0; round < rounds; ++round) {
#pragma GCC unroll 16
    for (int c = 0; c < kChains; ++c) chain[c] = chain[c] * factor + term;
  }
  Vector sum{};
#pragma GCC unroll 16
  for (int c = 0; c < kChains; ++c) sum += chain[c];
  float total = 0.0F;
  for (int i = 0; i < kVectorFloats; ++i) total += sum[i];
  return total;
}

}  // namespace
}  // namespace hqslam::nn::kernels

#include "row_bits.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "hqslam/core/connected_components.h"

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

// The loops below are compiled for several instruction sets; the dynamic loader picks one. The
// file is compiled with -ffp-contract=off, so all of them round alike.
#if defined(__x86_64__) && defined(__gnu_linux__) && defined(__GNUC__) && __GNUC__ >= 12 && \
    !defined(__clang__)
#define HQSLAM_CLONES __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define HQSLAM_CLONES
#endif

namespace hqslam::nn {

namespace {

/// 64 bytes of 0 or 1 as the bits of a word, the first byte lowest.
inline std::uint64_t packed(const std::uint8_t* flags) {
  std::uint64_t word = 0;
#if defined(__SSE2__)
  for (int part = 0; part < 4; ++part) {
    const __m128i bytes = _mm_loadu_si128(reinterpret_cast<const __m128i*>(flags + 16 * part));
    // 0 - 1 has the top bit set, which movemask collects.
    const int mask = _mm_movemask_epi8(_mm_sub_epi8(_mm_setzero_si128(), bytes));
    word |= static_cast<std::uint64_t>(static_cast<std::uint32_t>(mask)) << (16 * part);
  }
#else
  for (int i = 0; i < kWordBits; ++i) word |= static_cast<std::uint64_t>(flags[i]) << i;
#endif
  return word;
}

struct ConnectionWord {
  std::uint64_t present;
  std::uint64_t right;
  std::uint64_t down;
};

/// Reads 65 ranges of this row and 64 of the row below.
inline ConnectionWord connection_word(const float* row_m, const float* below_m,
                                      const ConnectionAngles& angles) {
  std::uint8_t present[kWordBits];
  std::uint8_t right[kWordBits];
  std::uint8_t down[kWordBits];
  for (int i = 0; i < kWordBits; ++i) present[i] = row_m[i] > 0.0F;
  for (int i = 0; i < kWordBits; ++i) {
    right[i] = ComponentLabeler::connected(row_m[i], row_m[i + 1], angles.horizontal_sin,
                                           angles.horizontal_cos, angles.tan_min_angle);
  }
  for (int i = 0; i < kWordBits; ++i) {
    down[i] = ComponentLabeler::connected(row_m[i], below_m[i], angles.down_sin, angles.down_cos,
                                          angles.tan_min_angle);
  }
  return {packed(present), packed(right), packed(down)};
}

}  // namespace

HQSLAM_CLONES void find_connections(const float* row_m, const float* below_m, int columns,
                                    const ConnectionAngles& angles, const ConnectionRow& result) {
  const int last = (columns - 1) / kWordBits;
  for (int word = 0; word < last; ++word) {
    const int column = word * kWordBits;
    const ConnectionWord bits = connection_word(row_m + column, below_m + column, angles);
    result.present[word] = bits.present;
    result.right[word] = bits.right;
    result.down[word] = bits.down;
  }
  // The last word would read beyond the row: it gets a copy that ends in pixels without a return.
  float row_end_m[kWordBits + 1] = {};
  float below_end_m[kWordBits] = {};
  std::copy(row_m + last * kWordBits, row_m + columns, row_end_m);
  std::copy(below_m + last * kWordBits, below_m + columns, below_end_m);
  const ConnectionWord bits = connection_word(row_end_m, below_end_m, angles);
  result.present[last] = bits.present;
  result.right[last] = bits.right;
  result.down[last] = bits.down;
  // At wide angles the formula holds for some pairs of negative ranges too.
  for (int word = 0; word < last; ++word) {
    result.right[word] &=
        result.present[word] & (result.present[word] >> 1 | result.present[word + 1] << 63);
  }
  result.right[last] &= result.present[last] & result.present[last] >> 1;
}

/// A run of n pixels is n - 1 set bits of `right`. Bit c stays where the next `length` bits are
/// all set; the length doubles until it is min_pixels - 1.
HQSLAM_CLONES void mark_long_runs(const std::uint64_t* right, int words, int min_pixels,
                                  std::uint64_t* marked) {
  if (min_pixels > words * kWordBits) {
    std::fill(marked, marked + words, std::uint64_t{0});
    return;
  }
  std::copy(right, right + words, marked);
  int length = 1;
  while (length < min_pixels - 1) {
    const int step = std::min({length, min_pixels - 1 - length, kWordBits - 1});
    for (int word = 0; word + 1 < words; ++word) {
      marked[word] &= (marked[word] >> step) | (marked[word + 1] << (kWordBits - step));
    }
    marked[words - 1] &= marked[words - 1] >> step;
    length += step;
  }
}

namespace {

/// In every word: marks what marked pixels reach within 1, 3, 7, ..., 63 pixels to both sides.
/// Bit c of `path` is set where column c is connected with column c + step.
inline void fill_within_words(const std::uint64_t* right, int words, std::uint64_t* marked) {
  for (int word = 0; word < words; ++word) {
    std::uint64_t path = right[word];
    std::uint64_t fill = marked[word];
    // Unrolled, so that the compiler works on several words at once.
#pragma GCC unroll 6
    for (int doubling = 0; doubling < 6; ++doubling) {
      const int step = 1 << doubling;
      fill |= ((fill & path) << step) | ((fill >> step) & path);
      path &= path >> step;
    }
    marked[word] = fill;
  }
}

/// Carries marks over the border between a word and the next, where just one side has them.
inline void fill_across_words(const std::uint64_t* right, int words, std::uint64_t* marked) {
  const auto differ = [&](int word) {
    return (right[word] >> 63 & (marked[word] >> 63 ^ (marked[word + 1] & 1))) != 0;
  };
  for (int word = 0; word + 1 < words; ++word) {
    if (differ(word) && marked[word] >> 63 != 0) {
      // The trailing ones and the zero behind them, the run's last pixel.
      marked[word + 1] |= right[word + 1] ^ (right[word + 1] + 1);
    }
  }
  for (int word = words - 2; word >= 0; --word) {
    if (differ(word)) {
      marked[word] |= ~std::uint64_t{0} << (kWordBits - std::countl_one(right[word]));
    }
  }
}

}  // namespace

HQSLAM_CLONES void fill_runs(const std::uint64_t* right, int words, std::uint64_t* marked) {
  fill_within_words(right, words, marked);
  fill_across_words(right, words, marked);
}

HQSLAM_CLONES int list_run_pairs(const std::uint64_t* down, const RunRow& upper,
                                 const RunRow& lower, int words, std::int32_t* pairs) {
  int count = 0;
  for (int word = 0; word < words; ++word) {
    const std::uint64_t upper_start = upper.start[word];
    const std::uint64_t lower_start = lower.start[word];
    const std::uint64_t connected = down[word] & upper.pixels[word] & lower.pixels[word];
    // Where neither row begins a run, the pair is that of the column before.
    const std::uint64_t repeated = connected << 1 & ~upper_start & ~lower_start;
    for (std::uint64_t left = connected & ~repeated; left != 0; left &= left - 1) {
      const std::uint64_t up_to_column = left ^ (left - 1);
      pairs[count++] = upper.first_run[word] + std::popcount(upper_start & up_to_column) - 1;
      pairs[count++] = lower.first_run[word] + std::popcount(lower_start & up_to_column) - 1;
    }
  }
  return count;
}

namespace {

/// For every byte, its bits as eight bytes of 0 or 1, the lowest bit first in memory.
constexpr std::array<std::array<std::uint8_t, 8>, 256> kBytesOfBits = [] {
  std::array<std::array<std::uint8_t, 8>, 256> table{};
  for (unsigned value = 0; value < 256; ++value) {
    for (unsigned bit = 0; bit < 8; ++bit) table[value][bit] = value >> bit & 1;
  }
  return table;
}();

}  // namespace

void unpack(const std::uint64_t* bits, int columns, std::uint8_t* bytes) {
  const auto eight_from = [&](int column) {
    return kBytesOfBits[bits[column / kWordBits] >> column % kWordBits & 0xFF].data();
  };
  int column = 0;
  for (; column + 8 <= columns; column += 8) std::memcpy(bytes + column, eight_from(column), 8);
  if (column < columns) std::memcpy(bytes + column, eight_from(column), columns - column);
}

}  // namespace hqslam::nn

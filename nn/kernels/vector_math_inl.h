#pragma once

// Vectors of kVectorFloats floats and the functions of them that the kernels need; included by the
// translation unit of each instruction set, all in an unnamed namespace (row_kernels_inl.h).

#include <cstdint>
#include <utility>

namespace hqslam::nn::kernels {
namespace {

// How wide a vector is, and how many sums one pass of row_kernels_inl.h keeps in registers, by what
// the compiler may use in the translation unit that includes this.
#if defined(__AVX512F__)
constexpr int kVectorFloats = 16;
constexpr int kChannelBlock = 8;
constexpr int kColumnVectors = 3;
constexpr int kGradientChannels = 8;
constexpr int kGradientTaps = 3;
#elif defined(__AVX2__)
constexpr int kVectorFloats = 8;
constexpr int kChannelBlock = 4;
constexpr int kColumnVectors = 3;
constexpr int kGradientChannels = 4;
constexpr int kGradientTaps = 3;
#else
constexpr int kVectorFloats = 4;
constexpr int kChannelBlock = 4;
constexpr int kGradientChannels = 4;
#ifdef __aarch64__
// NEON has 32 vector registers. Instructions of the innermost loops for every multiply-add: 1.8 and
// 1.7, with the smaller blocks 2.5 and 2.1; wider ones spill.
constexpr int kColumnVectors = 4;
constexpr int kGradientTaps = 4;
#else
constexpr int kColumnVectors = 2;
constexpr int kGradientTaps = 2;
#endif
#endif

typedef float Vector
    __attribute__((vector_size(kVectorFloats * sizeof(float)), aligned(4), may_alias));

inline Vector load(const float* values) { return *reinterpret_cast<const Vector*>(values); }
inline void store(float* values, Vector vector) { *reinterpret_cast<Vector*>(values) = vector; }

typedef std::int32_t IntVector __attribute__((vector_size(kVectorFloats * sizeof(float))));

/// e^v for v <= 0, relative error below 3e-7; e^-87 below -87. v = n ln 2 + f with |f| <= ln 2 / 2,
/// e^f by its Taylor series up to f^7, 2^n by writing n into the exponent.
inline Vector exponential(Vector v) {
  const Vector lowest = Vector{} - 87.0F;
  v = v > lowest ? v : lowest;
  const Vector scaled = v * 1.44269504F - 0.5F;
  const IntVector n = __builtin_convertvector(scaled, IntVector);  // towards zero: rounds v / ln 2
  const Vector whole = __builtin_convertvector(n, Vector);
  const Vector f = (v - whole * 0.693359375F) + whole * 2.12194440e-4F;  // ln 2 in two parts
  Vector sum = f * (1.0F / 5040.0F) + 1.0F / 720.0F;
  sum = sum * f + 1.0F / 120.0F;
  sum = sum * f + 1.0F / 24.0F;
  sum = sum * f + 1.0F / 6.0F;
  sum = sum * f + 0.5F;
  sum = sum * f + 1.0F;
  sum = sum * f + 1.0F;
  const IntVector bits = (n + 127) << 23;
  return sum * reinterpret_cast<const Vector&>(bits);
}

/// e^v for v <= 10.
inline Vector exponential_up_to_10(Vector v) { return exponential(v - 10.0F) * 22026.4658F; }

/// ln v for normal v > 0, absolute error below 2e-7. v = 2^n m with m in [1/sqrt 2, sqrt 2),
/// ln m = 2 (s + s^3/3 + ... + s^9/9) with s = (m - 1) / (m + 1).
inline Vector logarithm(Vector v) {
  const IntVector bits = __builtin_bit_cast(IntVector, v);
  const IntVector n = (bits - 0x3F3504F3) >> 23;  // 0x3F3504F3 is 1/sqrt 2
  const IntVector mantissa = bits - (n << 23);
  const Vector m = reinterpret_cast<const Vector&>(mantissa);
  const Vector s = (m - 1.0F) / (m + 1.0F);
  const Vector square = s * s;
  Vector sum = square * (1.0F / 9.0F) + 1.0F / 7.0F;
  sum = sum * square + 1.0F / 5.0F;
  sum = sum * square + 1.0F / 3.0F;
  sum = sum * square + 1.0F;
  return 2.0F * s * sum + __builtin_convertvector(n, Vector) * 0.693147181F;
}

inline Vector larger(Vector a, Vector b) { return a > b ? a : b; }
inline Vector smaller(Vector a, Vector b) { return a < b ? a : b; }
inline Vector magnitude(Vector v) { return larger(v, -v); }

/// 1 / sqrt v for normal v > 0, relative error below 3e-7: a first guess from halving the exponent,
/// and three steps of Newton's method.
inline Vector reciprocal_root(Vector v) {
  const IntVector guess = 0x5F3759DF - (__builtin_bit_cast(IntVector, v) >> 1);
  Vector root = __builtin_bit_cast(Vector, guess);
  for (int step = 0; step < 3; ++step) root *= 1.5F - 0.5F * v * root * root;
  return root;
}

/// atan2 with an error below 2e-4 rad.
inline Vector arc_tangent(Vector y, Vector x) {
  const Vector ax = magnitude(x);
  const Vector ay = magnitude(y);
  const Vector a = smaller(ax, ay) / larger(larger(ax, ay), Vector{} + 1e-20F);
  const Vector s = a * a;
  const Vector eighth = ((-0.0464964749F * s + 0.15931422F) * s - 0.327622764F) * s * a + a;
  constexpr float kQuarter = 1.57079633F;
  const Vector quarter = ay > ax ? kQuarter - eighth : eighth;
  const Vector half = x < 0.0F ? 2 * kQuarter - quarter : quarter;
  return y < 0.0F ? -half : half;
}

/// 1 / (1 + e^-v)
inline Vector logistic(Vector v) {
  const Vector e = exponential(-magnitude(v));
  const Vector small = e / (1.0F + e);
  return v > 0.0F ? 1.0F - small : small;
}

template <int kFirst, int... kLanes>
inline Vector every_second(Vector a, Vector b, std::integer_sequence<int, kLanes...>) {
  return __builtin_shufflevector(a, b, (kFirst + 2 * kLanes)...);
}

/// Lanes kFirst, kFirst + 2, ... of a, then of b.
template <int kFirst>
inline Vector every_second(Vector a, Vector b) {
  return every_second<kFirst>(a, b, std::make_integer_sequence<int, kVectorFloats>{});
}

template <int kFirst, int... kLanes>
inline Vector alternating(Vector a, Vector b, std::integer_sequence<int, kLanes...>) {
  return __builtin_shufflevector(a, b, (kFirst + kLanes / 2 + kLanes % 2 * kVectorFloats)...);
}

/// a[kFirst], b[kFirst], a[kFirst + 1], b[kFirst + 1], ...
template <int kFirst>
inline Vector alternating(Vector a, Vector b) {
  return alternating<kFirst>(a, b, std::make_integer_sequence<int, kVectorFloats>{});
}

inline float sum_of(Vector v) {
  float sum = 0.0F;
  for (int i = 0; i < kVectorFloats; ++i) sum += v[i];
  return sum;
}

}  // namespace
}  // namespace hqslam::nn::kernels

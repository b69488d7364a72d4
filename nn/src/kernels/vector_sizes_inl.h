#pragma once

// How wide a vector is in the translation unit that includes this, and how many sums one pass of
// row_kernels_inl.h keeps in registers, by what the compiler may use there.
namespace hqslam::nn::kernels {
namespace {
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
}  // namespace
}  // namespace hqslam::nn::kernels

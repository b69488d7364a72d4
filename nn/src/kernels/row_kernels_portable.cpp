namespace hqslam::nn::kernels {
namespace {
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
}  // namespace
}  // namespace hqslam::nn::kernels

#include "row_kernels_table_inl.h"

namespace hqslam::nn::kernels {
const RowKernels kPortableKernels = kKernels;
}  // namespace hqslam::nn::kernels

namespace hqslam::nn::kernels {
namespace {
constexpr int kVectorFloats = 16;
constexpr int kChannelBlock = 8;
constexpr int kColumnVectors = 3;
constexpr int kGradientChannels = 8;
constexpr int kGradientTaps = 3;
}  // namespace
}  // namespace hqslam::nn::kernels

#include "row_kernels_table_inl.h"

namespace hqslam::nn::kernels {
const RowKernels kAvx512Kernels = kKernels;
}  // namespace hqslam::nn::kernels

namespace hqslam::nn::kernels {
namespace {
constexpr int kVectorFloats = 8;
constexpr int kChannelBlock = 4;
constexpr int kColumnVectors = 3;
constexpr int kGradientChannels = 4;
constexpr int kGradientTaps = 3;
}  // namespace
}  // namespace hqslam::nn::kernels

#include "row_kernels_table_inl.h"

namespace hqslam::nn::kernels {
const RowKernels kAvx2Kernels = kKernels;
}  // namespace hqslam::nn::kernels

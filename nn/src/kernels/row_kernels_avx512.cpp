namespace hqslam::nn::kernels {
namespace {
constexpr int kVectorFloats = 16;
constexpr int kChannelBlock = 8;
constexpr int kColumnVectors = 3;
constexpr int kGradientChannels = 8;
constexpr int kGradientTaps = 3;
}  // namespace
}  // namespace hqslam::nn::kernels

#include "attention_inl.h"
#include "row_kernels_inl.h"
#include "two_modes_inl.h"
#include "winograd_inl.h"

namespace hqslam::nn::kernels {
const RowKernels kAvx512Kernels{accumulate,
                                correlate,
                                winograd_input,
                                winograd_output,
                                winograd_gradient,
                                split,
                                merge,
                                select,
                                select_gradient,
                                fill_measured,
                                interpolate,
                                two_modes,
                                two_modes_loss,
                                gelu,
                                attend,
                                attend_backward,
                                multiply_add_chains,
                                kChainMultiplyAdds};
}  // namespace hqslam::nn::kernels

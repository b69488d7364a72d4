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

#include "attention_inl.h"
#include "row_kernels_inl.h"
#include "two_modes_inl.h"
#include "winograd_inl.h"

namespace hqslam::nn::kernels {
const RowKernels kPortableKernels{accumulate,
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

// All kernels for one instruction set; included by its translation unit once it has said how wide a
// vector is (row_kernels_inl.h).

#include "row_kernels.h"
#include "row_kernels_inl.h"
#include "two_modes_inl.h"
#include "winograd_inl.h"

namespace hqslam::nn::kernels {
namespace {

constexpr RowKernels kKernels{accumulate,
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
                              multiply_add_chains,
                              kChainMultiplyAdds};

}  // namespace
}  // namespace hqslam::nn::kernels

#include "row_kernels.h"

#include "row_kernels_inl.h"
#include "see_points_inl.h"
#include "two_modes_inl.h"
#include "winograd_inl.h"

// Compiled once per instruction set, each time under another name (hqslam_kernels in CMakeLists).
namespace hqslam::nn::kernels {

const RowKernels HQSLAM_KERNELS{accumulate,        correlate,     winograd_input, winograd_output,
                                winograd_gradient, split,         merge,          select,
                                select_gradient,   fill_measured, interpolate,    two_modes,
                                two_modes_loss,    see_points};

}  // namespace hqslam::nn::kernels

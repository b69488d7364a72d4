#include "attention_kernels.h"

#include "attention_inl.h"

// Compiled once per instruction set, as nn's row_kernels.cpp.
namespace hqslam::nn::kernels {

const AttentionKernels HQSLAM_KERNELS{gelu, attend, attend_backward};

}  // namespace hqslam::nn::kernels

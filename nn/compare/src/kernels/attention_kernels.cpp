#include "attention_kernels.h"

// Compiled once per instruction set: CMakeLists.txt says how many floats a vector has and what the
// table is called.
namespace hqslam::nn::kernels {
namespace {
constexpr int kVectorFloats = HQSLAM_VECTOR_FLOATS;
}  // namespace
}  // namespace hqslam::nn::kernels

#include "attention_inl.h"

namespace hqslam::nn::kernels {
const AttentionKernels HQSLAM_KERNELS = {gelu, attend, attend_backward};
}  // namespace hqslam::nn::kernels

#pragma once

#include "hqslam/nn/instruction_set.h"

// The loops of transformers beside those of convolutions, compiled once per instruction set; raw
// pointers only (kernels/row_kernels.h).
namespace hqslam::nn::kernels {

/// output = input P(X < input) for a standard normal X; with d_output, its derivative times
/// d_output is added to output.
struct GeluRow {
  const float* input = nullptr;
  float* output = nullptr;
  const float* d_output = nullptr;
  int columns = 0;  ///< rounded up to whole vectors of 16
};

/// Attention of one head within one window. Queries, keys, values and output: depth x 16 pixels;
/// queries times 1 / sqrt(depth); depth a multiple of 4. bias, probabilities (a result): 16 keys x
/// 16 queries.
inline constexpr int kWindowPixels = 16;
struct AttentionWindow {
  int depth = 0;
  const float* queries = nullptr;
  const float* keys = nullptr;
  const float* values = nullptr;
  const float* bias = nullptr;
  float* probabilities = nullptr;
  float* output = nullptr;
};
/// Its gradients, after attend(forward).
struct AttentionGradient {
  AttentionWindow forward;
  const float* d_output = nullptr;
  float* d_queries = nullptr;
  float* d_keys = nullptr;
  float* d_values = nullptr;
  float* d_bias = nullptr;  ///< added to
};

struct AttentionKernels {
  void (*gelu)(const GeluRow&);
  void (*attend)(const AttentionWindow&);
  void (*attend_backward)(const AttentionGradient&);
};

/// The kernels of an instruction set that this processor has.
const AttentionKernels& attention_kernels(InstructionSet instruction_set);

// One for each time that attention_kernels.cpp is compiled.
extern const AttentionKernels kPortableAttention;
#ifdef HQSLAM_X86_KERNELS
extern const AttentionKernels kAvx2Attention;
extern const AttentionKernels kAvx512Attention;
#endif

}  // namespace hqslam::nn::kernels

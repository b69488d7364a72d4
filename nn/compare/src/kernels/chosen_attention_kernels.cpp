#include "attention_kernels.h"

namespace hqslam::nn::kernels {

const AttentionKernels& attention_kernels(InstructionSet instruction_set) {
#ifdef HQSLAM_X86_KERNELS
  if (instruction_set == InstructionSet::kAvx512) return kAvx512Attention;
  if (instruction_set == InstructionSet::kAvx2) return kAvx2Attention;
#endif
  static_cast<void>(instruction_set);
  return kPortableAttention;
}

}  // namespace hqslam::nn::kernels

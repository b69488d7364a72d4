#pragma once

#include <string_view>
#include <vector>

namespace hqslam::nn {

/// The instructions that kernels are compiled for. kPortable is baseline x86-64 (SSE2), or plain
/// vectors as the compiler translates them on another processor.
enum class InstructionSet { kPortable, kAvx2, kAvx512 };

/// "portable", "avx2" (AVX2 and FMA), "avx512" (AVX-512F)
std::string_view name(InstructionSet instruction_set);

/// The instruction sets that this build has and this processor runs, narrowest first.
std::vector<InstructionSet> available_instruction_sets();

/// The widest available one, or the one that the environment variable HQSLAM_INSTRUCTION_SET
/// names. Throws Error if it names one that is not available.
InstructionSet chosen_instruction_set();

}  // namespace hqslam::nn

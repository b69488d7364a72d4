#include "hqslam/nn/instruction_set.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string>

#include "architecture.h"
#include "hqslam/core/error.h"
#include "kernels/row_kernels.h"

namespace hqslam::nn {

std::string_view name(InstructionSet instruction_set) {
  constexpr std::array<std::string_view, 3> kNames = {"portable", "avx2", "avx512"};
  return kNames[static_cast<std::size_t>(instruction_set)];
}

std::vector<InstructionSet> available_instruction_sets() {
  std::vector<InstructionSet> available{InstructionSet::kPortable};
#ifdef HQSLAM_X86_KERNELS
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
    available.push_back(InstructionSet::kAvx2);
    if (__builtin_cpu_supports("avx512f")) available.push_back(InstructionSet::kAvx512);
  }
#endif
  return available;
}

namespace {

/// The rest of a message about one that is none of them.
std::string expected_names() {
  std::vector<std::string_view> names;
  for (const InstructionSet available : available_instruction_sets()) {
    names.push_back(name(available));
  }
  return fmt::format("expected one that this processor and build have: {}", fmt::join(names, ", "));
}

}  // namespace

InstructionSet chosen_instruction_set() {
  const std::vector<InstructionSet> available = available_instruction_sets();
  const char* wanted = std::getenv("HQSLAM_INSTRUCTION_SET");
  if (wanted == nullptr) return available.back();
  for (const InstructionSet instruction_set : available) {
    if (name(instruction_set) == wanted) return instruction_set;
  }
  throw Error("HQSLAM_INSTRUCTION_SET is '{}', {}", wanted, expected_names());
}

void require_available(InstructionSet instruction_set) {
  const std::vector<InstructionSet> available = available_instruction_sets();
  if (std::ranges::find(available, instruction_set) != available.end()) return;
  throw Error("network: instruction set number {}, {}", static_cast<int>(instruction_set),
              expected_names());
}

namespace kernels {

const RowKernels& row_kernels(InstructionSet instruction_set) {
#ifdef HQSLAM_X86_KERNELS
  if (instruction_set == InstructionSet::kAvx512) return kAvx512Kernels;
  if (instruction_set == InstructionSet::kAvx2) return kAvx2Kernels;
#endif
  static_cast<void>(instruction_set);
  return kPortableKernels;
}

}  // namespace kernels
}  // namespace hqslam::nn

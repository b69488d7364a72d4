#include "hqslam/nn/instruction_set.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <omp.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <cstdlib>

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

InstructionSet chosen_instruction_set() {
  const std::vector<InstructionSet> available = available_instruction_sets();
  const char* wanted = std::getenv("HQSLAM_INSTRUCTION_SET");
  if (wanted == nullptr) return available.back();
  std::vector<std::string_view> names;
  for (const InstructionSet instruction_set : available) {
    if (name(instruction_set) == wanted) return instruction_set;
    names.push_back(name(instruction_set));
  }
  throw Error("HQSLAM_INSTRUCTION_SET is '{}', expected one that this processor and build have: {}",
              wanted, fmt::join(names, ", "));
}

double multiply_add_peak_gflops(InstructionSet instruction_set, int threads, int attempts) {
  constexpr std::int64_t kRounds = 4'000'000;  // 5 to 30 ms
  const kernels::RowKernels& kernels = kernels::row_kernels(instruction_set);
  const auto flops = static_cast<double>(2 * kRounds * threads * kernels.chain_multiply_adds);
  std::atomic<float> sink = 0.0F;  // keeps the results alive
  double best = 0.0;
  for (int attempt = 0; attempt < attempts; ++attempt) {
    double start_s = 0.0;
#pragma omp parallel num_threads(threads)
    {
#pragma omp barrier
#pragma omp single
      start_s = omp_get_wtime();
      sink = kernels.multiply_add_chains(kRounds, sink.load());
    }
    best = std::max(best, 1e-9 * flops / (omp_get_wtime() - start_s));
  }
  return best;
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

#include "hqslam/nn/multiply_add_peak.h"

#include <omp.h>

#include <algorithm>
#include <atomic>
#include <cstdint>

#include "kernels/row_kernels.h"

namespace hqslam::nn {

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

}  // namespace hqslam::nn

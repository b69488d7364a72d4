#include "hqslam/nn/multiply_add_peak.h"

#include <doctest/doctest.h>

namespace hqslam::nn {

TEST_CASE("every instruction set's peak is a processor's, and wider ones lose at most half of it") {
  double narrower = 0.1;  // GFLOP/s
  for (const InstructionSet instruction_set : available_instruction_sets()) {
    const double peak = multiply_add_peak_gflops(instruction_set, 1, 5);
    CHECK(peak < 10'000.0);
    // AVX-512 runs on two halves on some processors; anything else may take time away.
    CHECK(peak > 0.5 * narrower);
    narrower = peak;
  }
}

}  // namespace hqslam::nn

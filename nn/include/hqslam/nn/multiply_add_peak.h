#pragma once

#include "hqslam/nn/instruction_set.h"

namespace hqslam::nn {

/// What `threads` threads of this processor can do at most: float32 multiply-adds in registers, in
/// so many independent chains that only the arithmetic units limit them. GFLOP/s, two operations
/// per multiply-add; the best of `attempts` attempts of 5 to 30 ms each.
double multiply_add_peak_gflops(InstructionSet instruction_set, int threads, int attempts = 10);

}  // namespace hqslam::nn

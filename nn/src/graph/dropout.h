#pragma once

#include <cstdint>

#include "../tensor.h"

namespace hqslam::nn {

/// Each value is dropped with a probability of `share`, or else divided by 1 - share, so that the
/// mean stays; seed and place alone decide. Called by all threads of a parallel region, they share
/// the work; borders too.
void drop_out(std::uint64_t seed, float share, Tensor& values);

/// The gradient before, from that behind: nothing for what was dropped, which is 0 now. A value
/// that was 0 before must be one that an activation has cut off and that has no gradient. One
/// thread; borders too.
void drop_out_backward(float share, const Tensor& values, Tensor& gradient);

}  // namespace hqslam::nn

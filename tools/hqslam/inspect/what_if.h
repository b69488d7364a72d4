#pragma once

#include <string>

#include "hqslam/nn/weights_file.h"

namespace hqslam::tools {

/// The network of these weights with other settings of its loop, to see what a term of eq. 10 does.
/// The learned parameters stay as they were trained. change: one or more of, with commas between:
///   b=NUMBER   the penalty of every layer (eq. 5), 0 or more
///   layers=N   the first N layers alone, as many as were trained at most
///   y=zero     Y = 0 in a pixel that the filter rejects; y=other: the iterate that is not filtered
///   q=z        the filter works on Z, as in the paper's prose; q=h: on H, as in eq. 10c
///   angle=DEGREES, pixels=N   the filter's least angle (eq. 9), and the least component that stays
///   no-q       without the filter in the layers
///   literal    y=zero, q=h and G(H) without L: eq. 10 as it is written
/// Throws Error for other changes, or where the network has no such setting.
nn::Weights what_if(const nn::Weights& weights, const std::string& change);

}  // namespace hqslam::tools

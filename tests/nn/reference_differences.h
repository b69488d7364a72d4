#pragma once

#include "hqslam/nn/reference/reference.h"
#include "testing.h"

namespace hqslam::nn {

/// Holds a trace's tensors against those of the reference; the names of all that it held.
inline std::set<std::string> compared_with_reference(const NetworkDescription& description,
                                                     const std::vector<float>& parameters,
                                                     const Trace& trace) {
  std::set<std::string> compared;
  for (const ReferenceDifference& difference :
       differences_from_reference(description, parameters, trace)) {
    CAPTURE(difference.name);
    CAPTURE(difference.largest);
    const TracedTensor& tensor = trace.tensor(difference.name);
    float scale = 1.0F;
    for (const float value : tensor.all()) scale = std::max(scale, std::fabs(value));
    CHECK(difference.largest < 1e-4 * scale);
    CHECK(difference.root_mean_square <= difference.largest);
    CHECK(difference.unit == tensor.unit);
    compared.insert(difference.name);
  }
  return compared;
}

}  // namespace hqslam::nn

#include "hqslam/nn/architectures.h"

#include "hqs/hqs_architecture.h"

namespace hqslam::nn {

const Architectures& hqs_architectures() {
  static const Architectures kinds{
      {"du-or", [](JsonFields& network) { return read_hqs(kDuOr, network); }},
      {"simple-du", [](JsonFields& network) { return read_hqs(kSimpleDu, network); }},
      {"du-mix", [](JsonFields& network) { return read_hqs(kDuMix, network); }}};
  return kinds;
}

}  // namespace hqslam::nn

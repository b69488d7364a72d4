#include "hqslam/nn/hqs/network.h"

#include "two_modes_network.h"
#include "unrolled_lifter.h"

namespace hqslam::nn {

std::unique_ptr<Network> make_network(const NetworkDescription& description, int columns,
                                      InstructionSet instruction_set, int threads) {
  validate(description);
  if (description.kind == NetworkKind::kDuMix) {
    return std::make_unique<TwoModesNetwork>(description, columns, instruction_set, threads);
  }
  return std::make_unique<UnrolledLifter>(description, columns, instruction_set, threads);
}

}  // namespace hqslam::nn

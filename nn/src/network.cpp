#include "hqslam/nn/network.h"

#include "architecture.h"
#include "hqslam/core/error.h"
#include "parameters.h"

namespace hqslam::nn {

std::unique_ptr<Network> make_network(const NetworkDescription& description, int columns,
                                      InstructionSet instruction_set, int threads) {
  constexpr int kMostThreads = 1024;
  require_available(instruction_set);
  check_field("threads", threads, 1, kMostThreads);
  check_columns(description, columns);
  return description.architecture->make_network(description, columns, instruction_set, threads);
}

}  // namespace hqslam::nn

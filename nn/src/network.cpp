#include "hqslam/nn/network.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "architecture.h"
#include "hqslam/core/error.h"
#include "parameters.h"

namespace hqslam::nn {

void require_available(InstructionSet instruction_set) {
  const std::vector<InstructionSet> available = available_instruction_sets();
  if (std::ranges::find(available, instruction_set) != available.end()) return;
  std::vector<std::string_view> names;
  for (const InstructionSet one : available) names.push_back(name(one));
  throw Error(
      "network: instruction set number {}, expected one that this processor and build have: {}",
      static_cast<int>(instruction_set), fmt::join(names, ", "));
}

std::unique_ptr<Network> make_network(const NetworkDescription& description, int columns,
                                      InstructionSet instruction_set, int threads) {
  constexpr int kMostThreads = 1024;
  require_available(instruction_set);
  check_field("threads", threads, 1, kMostThreads);
  check_columns(description, columns);
  return description.architecture->make_network(description, columns, instruction_set, threads);
}

}  // namespace hqslam::nn

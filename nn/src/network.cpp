#include "hqslam/nn/network.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "architecture.h"
#include "hqslam/core/error.h"

namespace hqslam::nn {
namespace {

void require_available(InstructionSet instruction_set) {
  const std::vector<InstructionSet> available = available_instruction_sets();
  if (std::find(available.begin(), available.end(), instruction_set) != available.end()) return;
  std::vector<std::string_view> names;
  for (const InstructionSet one : available) names.push_back(name(one));
  throw Error(fmt::format(
      "network: instruction set number {}, expected one that this processor and build have: {}",
      static_cast<int>(instruction_set), fmt::join(names, ", ")));
}

}  // namespace

double Network::add_gradients(std::span<const TrainingSample> batch, const LossOptions& options,
                              std::span<const std::uint64_t> seeds, std::span<float> d_parameters) {
  double loss = 0.0;
  for (std::size_t i = 0; i < batch.size(); ++i) {
    loss += add_gradient(batch[i].measured, batch[i].truth, options, seeds[i], d_parameters);
  }
  return loss;
}

std::unique_ptr<Network> make_network(const NetworkDescription& description, int columns,
                                      InstructionSet instruction_set, int threads) {
  require_available(instruction_set);
  validate(description);
  check_columns(description, columns);
  return description.architecture->make_network(description, columns, instruction_set, threads);
}

}  // namespace hqslam::nn

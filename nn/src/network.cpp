#include "hqslam/nn/hqs/network.h"

#include "architecture.h"

namespace hqslam::nn {

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
  validate(description);
  check_columns(description, columns);
  return description.architecture->make_network(description, columns, instruction_set, threads);
}

}  // namespace hqslam::nn

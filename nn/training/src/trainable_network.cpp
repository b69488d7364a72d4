#include "hqslam/nn/training/trainable_network.h"

#include <exception>
#include <optional>

#include "architecture.h"
#include "hqs/hqs_backward.h"
#include "hqslam/core/error.h"
#include "trainable_architecture.h"

namespace hqslam::nn {
namespace {

/// The loop of eq. 10, forward and back.
class TrainableHqs final : public TrainableNetwork {
 public:
  TrainableHqs(const NetworkDescription& description, int columns, InstructionSet instruction_set)
      : description_(description),
        hqs_(description, columns, {instruction_set, 1}),
        state_(hqs_.make_state(true)),
        gradient_(hqs_),
        truth_(hqs_.z0) {}

  void set_parameters(std::span<const float> parameters) override {
    hqs_.set_parameters(parameters);
    gradient_.take_parameters(parameters);
  }

 private:
  double batch_gradients(std::span<const TrainingSample> batch, const LossOptions& options,
                         std::span<const std::uint64_t> seeds,
                         std::span<float> d_parameters) override {
    double loss = 0.0;
    for (std::size_t i = 0; i < batch.size(); ++i) {
      loss += add_gradient(batch[i], options, seeds[i], d_parameters);
    }
    return loss;
  }

  double add_gradient(const TrainingSample& sample, const LossOptions& options, std::uint64_t seed,
                      std::span<float> d_parameters) {
    gradient_.backward(0).put_truth(sample.truth, description_.range_scale_m, truth_);
    hqs_loop(hqs_, {sample.measured, sample.recalled}, state_, {.dropout_seed = seed});
    const LayerLoss loss = [&](int k, const PriorState& state, PriorState& gradient) {
      const bool last = k + 1 == hqs_.layers;
      const LossTarget target{
          .truth = truth_,
          .restored_rows = last ? std::optional(description_.measured_rows) : std::nullopt,
          .share = last ? 1.0F : options.layer_share};
      return gradient_.backward(k).loss(state, target, gradient);
    };
    return hqs_backward(hqs_, state_, loss, gradient_, d_parameters);
  }

  NetworkDescription description_;
  Hqs hqs_;
  HqsState state_;
  HqsGradient gradient_;
  Tensor truth_;
};

}  // namespace

double TrainableNetwork::add_gradients(std::span<const TrainingSample> batch,
                                       const LossOptions& options,
                                       std::span<const std::uint64_t> seeds,
                                       std::span<float> d_parameters) {
  // In a team of its own one thread does all that a team shares, whatever region the caller is in.
  double loss = 0.0;
  std::exception_ptr thrown;
#pragma omp parallel num_threads(1)
  try {
    loss = batch_gradients(batch, options, seeds, d_parameters);
  } catch (...) {
    thrown = std::current_exception();
  }
  if (thrown != nullptr) std::rethrow_exception(thrown);
  return loss;
}

std::unique_ptr<TrainableNetwork> make_trainable(const NetworkDescription& description, int columns,
                                                 InstructionSet instruction_set) {
  require_available(instruction_set);
  check_columns(description, columns);
  const Architecture* architecture = description.architecture.get();
  if (dynamic_cast<const HqsArchitecture*>(architecture) != nullptr) {
    return std::make_unique<TrainableHqs>(description, columns, instruction_set);
  }
  if (const auto* own = dynamic_cast<const TrainableArchitecture*>(architecture)) {
    return own->make_trainable(description, columns, instruction_set);
  }
  throw Error("training: no gradients for networks of kind {}, expected one that can be trained",
              name(description));
}

}  // namespace hqslam::nn

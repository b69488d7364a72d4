#include <cmath>

#include "direct_network.h"
#include "graph/graph_backward.h"

namespace hqslam::nn {
namespace {

/// Trained with the mean of the absolute errors over all pixels, no return counting as 0.
class TrainableDirectNetwork final : public TrainableNetwork {
 public:
  TrainableDirectNetwork(LayerGraph graph, const DirectUnit& unit)
      : unit_(unit), graph_(std::move(graph)), backward_(graph_) {}

  void set_parameters(std::span<const float> parameters) override {
    graph_.set_parameters(parameters);
    backward_.set_parameters(parameters);
  }

 private:
  double batch_gradients(std::span<const TrainingSample> batch, const LossOptions& /*options*/,
                         std::span<const std::uint64_t> seeds,
                         std::span<float> d_parameters) override {
    while (values_.size() < batch.size()) {
      values_.push_back(graph_.make_values());
      gradients_.push_back(graph_.make_values());
    }
    const std::span values(values_.data(), batch.size());
    const std::span gradients(gradients_.data(), batch.size());
    for (std::size_t i = 0; i < batch.size(); ++i) unit_.take(batch[i].measured, values[i].front());
    backward_.forward_batch(values, seeds);
    double loss = 0.0;
    for (std::size_t i = 0; i < batch.size(); ++i) {
      loss += add_loss(batch[i].truth, values[i].back(), gradients[i].back());
    }
    backward_.backward(values, gradients, d_parameters, {.dropped = true});
    return loss;
  }

  double add_loss(const RangeImage& truth, const Tensor& output, Tensor& d_output) const {
    const float share = 1.0F / static_cast<float>(truth.range_m.size());
    double loss = 0.0;
    for (int y = 0; y < output.rows(); ++y) {
      for (int x = 0; x < output.columns(); ++x) {
        const float off = output.at(0, y, x) - unit_.of(truth.at(y, x));
        loss += std::fabs(off) * share;
        d_output.at(0, y, x) = off > 0.0F ? share : off < 0.0F ? -share : 0.0F;
      }
    }
    return loss;
  }

  DirectUnit unit_;
  LayerGraph graph_;
  GraphBackward backward_;
  std::vector<LayerGraph::Values> values_;  ///< of each scan of a batch
  std::vector<LayerGraph::Values> gradients_;
};

}  // namespace

std::unique_ptr<TrainableNetwork> DirectArchitecture::make_trainable(
    const NetworkDescription& d, int columns, InstructionSet instruction_set) const {
  return std::make_unique<TrainableDirectNetwork>(
      graph(d, columns, Purpose::kTraining, {instruction_set, 1}),
      DirectUnit{d.range_scale_m, plan().logarithmic});
}

}  // namespace hqslam::nn

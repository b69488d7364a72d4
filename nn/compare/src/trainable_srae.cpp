#include <cmath>

#include "graph/graph_backward.h"
#include "srae_network.h"

namespace hqslam::nn {
namespace {

/// Trained with the mean of the absolute errors over all pixels, no return counting as 0.
class TrainableSrae final : public TrainableNetwork {
 public:
  TrainableSrae(LayerGraph graph, float range_scale_m)
      : range_scale_m_(range_scale_m), graph_(std::move(graph)), backward_(graph_) {}

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
    for (std::size_t i = 0; i < batch.size(); ++i) {
      take_scaled(batch[i].measured, range_scale_m_, values[i].front());
    }
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
        const float off = output.at(0, y, x) - scaled_range(truth.at(y, x), range_scale_m_);
        loss += std::fabs(off) * share;
        d_output.at(0, y, x) = off > 0.0F ? share : off < 0.0F ? -share : 0.0F;
      }
    }
    return loss;
  }

  float range_scale_m_;
  LayerGraph graph_;
  GraphBackward backward_;
  std::vector<LayerGraph::Values> values_;  ///< of each scan of a batch
  std::vector<LayerGraph::Values> gradients_;
};

}  // namespace

std::unique_ptr<TrainableNetwork> Srae::make_trainable(const NetworkDescription& d, int columns,
                                                       InstructionSet instruction_set) const {
  return std::make_unique<TrainableSrae>(graph(d, columns, {instruction_set, 1}), d.range_scale_m);
}

}  // namespace hqslam::nn

#include "graph_backward.h"

#include "hqslam/core/error.h"

namespace hqslam::nn {

GraphBackward::GraphBackward(LayerGraph& graph) : graph_(graph) {
  users_.resize(graph.nodes().size());
  for (int index = 0; const LayerGraph::Node& node : graph.nodes()) {
    for (const int input : node.inputs) {
      if (users_[input].first < 0) users_[input].first = index;
      users_[input].last = index;
    }
    if (auto* convolution = dynamic_cast<ConvolutionLayer*>(node.layer.get())) {
      convolutions_.push_back(std::make_unique<ConvolutionBackward>(*convolution, graph.engine()));
      layers_.push_back(convolutions_.back().get());
    } else if (auto* own = dynamic_cast<LayerBackward*>(node.layer.get())) {
      layers_.push_back(own);
    } else {
      throw Error("network: layer '{}' has no gradients, expected one that can be trained",
                  node.name);
    }
    ++index;
  }
}

void GraphBackward::set_parameters(std::span<const float> parameters) {
  for (std::size_t layer = 0; layer < layers_.size(); ++layer) {
    layers_[layer]->set_parameters(take(parameters, graph_.nodes()[layer].parameters));
  }
}

void GraphBackward::forward_batch(std::span<Values> batch, std::span<const std::uint64_t> seeds) {
  for (int layer = 0; layer < std::ssize(layers_); ++layer) {
    std::vector<LayerPass> passes;
    for (Values& values : batch) passes.push_back(graph_.pass_of(layer, values));
    layers_[layer]->forward_batch(passes);
    for (std::size_t i = 0; i < batch.size(); ++i) {
      graph_.drop_out_of(layer, seeds[i], batch[i][layer + 1]);
    }
  }
}

/// How a layer that ends gradients writes that of its input: on top of what later layers, or its
/// own second input, have put there; the first layer that takes the tensor is the last to come.
LayerEnd GraphBackward::input_gradient_end(int layer, const Values& values,
                                           const Values& gradients) const {
  const std::vector<int>& inputs = graph_.nodes()[layer].inputs;
  const int tensor = inputs[0];
  LayerEnd end;
  if (layer != users_[tensor].last || (inputs.size() > 1 && inputs[1] == tensor)) {
    end.skip = &gradients[tensor];
  }
  if (layer == users_[tensor].first && tensor > 0) {
    end.negative_slope = graph_.nodes()[tensor - 1].layer->negative_slope();
    if (end.negative_slope != 1.0F) end.activated = &values[tensor];
  }
  return end;
}

/// Once all that take the tensor have put their part there.
void GraphBackward::finish_gradient(int tensor, const Values& values, bool dropped,
                                    Values& gradients) const {
  const LayerGraph::Node& node = graph_.nodes()[tensor - 1];
  const int last_part = tensor < std::ssize(users_) ? users_[tensor].first : -1;
  const bool ended = last_part >= 0 && layers_[last_part]->ends_gradients() &&
                     graph_.nodes()[last_part].inputs[0] == tensor;
  if (!ended) {
    leaky_relu_backward(node.layer->negative_slope(), values[tensor], gradients[tensor]);
  }
  if (dropped && node.dropout > 0.0F) {
    drop_out_backward(node.dropout, values[tensor], gradients[tensor]);
  }
}

BackwardPass GraphBackward::backward_pass(int layer, const Values& values,
                                          Values& gradients) const {
  const LayerGraph::Node& node = graph_.nodes()[layer];
  const bool ends = layers_[layer]->ends_gradients();
  BackwardPass pass{.input = &values[node.inputs[0]],
                    .d_output = &gradients[layer + 1],
                    .d_input = &gradients[node.inputs[0]]};
  if (ends) pass.end = input_gradient_end(layer, values, gradients);
  if (!ends && layer == users_[node.inputs[0]].last) pass.d_input->set_zero();
  if (node.inputs.size() > 1) {
    pass.d_second = &gradients[node.inputs[1]];
    if (layer == users_[node.inputs[1]].last) pass.d_second->set_zero();
  }
  return pass;
}

void GraphBackward::backward(std::span<const Values> batch, std::span<Values> gradients,
                             std::span<float> d_parameters, const BackwardOptions& how) {
  std::int64_t end = std::ssize(d_parameters);
  for (int layer = static_cast<int>(layers_.size()) - 1; layer >= 0; --layer) {
    const LayerGraph::Node& node = graph_.nodes()[layer];
    end -= node.parameters;
    if (layer + how.left_out >= static_cast<int>(layers_.size())) continue;
    std::vector<BackwardPass> passes;
    for (std::size_t i = 0; i < batch.size(); ++i) {
      finish_gradient(layer + 1, batch[i], how.dropped, gradients[i]);
      passes.push_back(backward_pass(layer, batch[i], gradients[i]));
    }
    layers_[layer]->backward(passes, d_parameters.subspan(end, node.parameters));
  }
}

void GraphBackward::last_backward_rows(const Values& values, int first_row, const Tensor& d_output,
                                       Values& gradients, std::span<float> d_parameters) {
  const auto layer = static_cast<int>(layers_.size()) - 1;
  const int from = graph_.nodes()[layer].inputs[0];
  convolutions_.back()->backward_rows(values[from], first_row, d_output,
                                      input_gradient_end(layer, values, gradients), gradients[from],
                                      d_parameters.last(graph_.nodes()[layer].parameters));
}

void drop_out_backward(float share, const Tensor& values, Tensor& gradient) {
  for (int channel = 0; channel < values.channels(); ++channel) {
    for (int y = 0; y < values.rows(); ++y) {
      const float* value = values.row(channel, y);
      float* d = gradient.row(channel, y);
      for (int x = 0; x < values.columns(); ++x) {
        d[x] = value[x] == 0.0F ? 0.0F : kept_scale(share) * d[x];
      }
      gradient.fill_border(channel, y);
    }
  }
}

void leaky_relu_backward(float slope, const Tensor& output, Tensor& d_values) {
  for (int channel = 0; channel < output.channels(); ++channel) {
    for (int y = 0; y < output.rows(); ++y) {
      const float* out = output.row(channel, y);
      float* gradient = d_values.row(channel, y);
#pragma omp simd
      for (int x = 0; x < output.columns(); ++x) {
        gradient[x] *= out[x] > 0.0F ? 1.0F : slope;
      }
      d_values.fill_border(channel, y);
    }
  }
}

}  // namespace hqslam::nn

#include "layer_graph.h"

#include "../random.h"
#include "hqslam/core/error.h"

namespace hqslam::nn {
namespace {

/// Of the dropout number 0, 1, ... of a graph. A loop that runs graphs for one sample gives them
/// seeds 10 apart: from the eleventh on they lie elsewhere, or masks would come again.
std::uint64_t dropout_seed(std::uint64_t seed, std::uint64_t number) {
  return seed + number % 10 + ((number / 10) << 60U);
}

float kept_scale(float share) { return 1.0F / (1.0F - share); }

/// A number from 0 to below 1 for each place, so that it does not matter who asks first.
float unit_random(std::uint64_t seed, std::uint64_t place) {
  Random random(seed + 0x9E3779B97F4A7C15ULL * place);
  return static_cast<float>(random.bits() >> 40) / static_cast<float>(1 << 24);
}

}  // namespace

int LayerGraph::add(const std::string& name, std::unique_ptr<Layer> layer, std::vector<int> inputs,
                    float dropout) {
  const auto index = static_cast<int>(nodes_.size());
  std::uint64_t dropouts_before = 0;
  for (const Node& node : nodes_) dropouts_before += node.dropout > 0.0F ? 1 : 0;
  users_.resize(shapes_.size());
  for (const int input : inputs) {
    if (users_[input].first < 0) users_[input].first = index;
    users_[input].last = index;
  }
  shapes_.push_back(layer->output_shape());
  const std::int64_t parameters = elements(layer->parameter_shapes());
  nodes_.push_back(
      {name, std::move(layer), std::move(inputs), dropout, parameters, dropouts_before});
  last_convolution_ = nullptr;
  return index + 1;
}

int LayerGraph::add(const std::string& name, const ConvolutionOptions& options,
                    std::vector<int> inputs, float dropout) {
  auto layer = std::make_unique<ConvolutionLayer>(options, shapes_[inputs.front()], engine_);
  if (inputs.size() > 1 && shapes_[inputs[1]] != layer->output_shape()) {
    const TensorShape& added = shapes_[inputs[1]];
    const TensorShape& sum = layer->output_shape();
    throw Error(
        "network: '{}' adds {} x {} x {} values to {} x {} x {}, expected as many; take images "
        "whose rows and columns all strides divide",
        name, added.channels, added.rows, added.columns, sum.channels, sum.rows, sum.columns);
  }
  ConvolutionLayer* const convolution = layer.get();
  const int tensor = add(name, std::move(layer), std::move(inputs), dropout);
  last_convolution_ = convolution;
  return tensor;
}

std::vector<ParameterShape> LayerGraph::parameter_shapes() const {
  std::vector<ParameterShape> shapes;
  for (const Node& node : nodes_) add_part(node.name, node.layer->parameter_shapes(), shapes);
  return shapes;
}

std::vector<float> LayerGraph::initial_parameters(std::uint64_t seed) const {
  UniformStart start(seed);
  std::vector<float> parameters;
  for (const Node& node : nodes_) node.layer->add_initial_parameters(start, parameters);
  return parameters;
}

std::int64_t LayerGraph::multiply_adds(int first) const {
  std::int64_t sum = 0;
  for (std::size_t i = first; i < nodes_.size(); ++i) sum += nodes_[i].layer->multiply_adds();
  return sum;
}

void LayerGraph::set_parameters(std::span<const float> parameters) {
  check_parameters(parameters, parameter_shapes());
  for (const Node& node : nodes_) node.layer->set_parameters(take(parameters, node.parameters));
}

LayerGraph::Values LayerGraph::make_values() const {
  Values values;
  for (const TensorShape& shape : shapes_) values.push_back(shape.make());
  return values;
}

std::int64_t LayerGraph::values() const {
  std::int64_t sum = 0;
  for (const TensorShape& shape : shapes_) sum += shape.values();
  return sum;
}

LayerPass LayerGraph::pass_of(int layer, Values& values) const {
  const std::vector<int>& inputs = nodes_[layer].inputs;
  return {&values[inputs[0]], inputs.size() > 1 ? &values[inputs[1]] : nullptr, &values[layer + 1]};
}

void LayerGraph::forward(Values& values, const GraphForward& how) {
  const int end = static_cast<int>(nodes_.size()) - how.left_out;
  for (int layer = how.first; layer < end; ++layer) {
    const Node& node = nodes_[layer];
    node.layer->forward(pass_of(layer, values));
    if (how.seed && node.dropout > 0.0F) {
      drop_out(dropout_seed(*how.seed, node.dropouts_before), node.dropout, values[layer + 1]);
    }
  }
}

int LayerGraph::first_random_layer() const {
  int layer = 0;
  for (const Node& node : nodes_) {
    if (node.dropout > 0.0F) break;
    ++layer;
  }
  return layer;
}

void LayerGraph::last_row(const Values& values, int row, float* output,
                          std::int64_t channel_stride) const {
  last_convolution_->forward_row(values[nodes_.back().inputs[0]], row, output, channel_stride);
}

void LayerGraph::forward_batch(std::span<Values> batch, std::span<const std::uint64_t> seeds) {
  for (int layer = 0; layer < static_cast<int>(nodes_.size()); ++layer) {
    const Node& node = nodes_[layer];
    std::vector<LayerPass> passes;
    for (Values& values : batch) passes.push_back(pass_of(layer, values));
    node.layer->forward_batch(passes);
    if (node.dropout == 0.0F) continue;
    for (std::size_t i = 0; i < batch.size(); ++i) {
      drop_out(dropout_seed(seeds[i], node.dropouts_before), node.dropout, batch[i][layer + 1]);
    }
  }
}

/// How a layer that ends gradients writes that of its input: on top of what later layers, or its
/// own second input, have put there; the first layer that takes the tensor is the last to come.
LayerEnd LayerGraph::input_gradient_end(int layer, const Values& values,
                                        const Values& gradients) const {
  const std::vector<int>& inputs = nodes_[layer].inputs;
  const int tensor = inputs[0];
  LayerEnd end;
  if (layer != users_[tensor].last || (inputs.size() > 1 && inputs[1] == tensor)) {
    end.skip = &gradients[tensor];
  }
  if (layer == users_[tensor].first && tensor > 0) {
    end.negative_slope = nodes_[tensor - 1].layer->negative_slope();
    if (end.negative_slope != 1.0F) end.activated = &values[tensor];
  }
  return end;
}

/// Once all that take the tensor have put their part there.
void LayerGraph::finish_gradient(int tensor, const Values& values, bool dropped,
                                 Values& gradients) const {
  const Node& node = nodes_[tensor - 1];
  const int last_part = tensor < std::ssize(users_) ? users_[tensor].first : -1;
  const bool ended = last_part >= 0 && nodes_[last_part].layer->ends_gradients() &&
                     nodes_[last_part].inputs[0] == tensor;
  if (!ended) {
    leaky_relu_backward(node.layer->negative_slope(), values[tensor], gradients[tensor]);
  }
  if (dropped && node.dropout > 0.0F) {
    drop_out_backward(node.dropout, values[tensor], gradients[tensor]);
  }
}

BackwardPass LayerGraph::backward_pass(int layer, const Values& values, Values& gradients) const {
  const Node& node = nodes_[layer];
  const bool ends = node.layer->ends_gradients();
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

void LayerGraph::backward(std::span<const Values> batch, std::span<Values> gradients,
                          std::span<float> d_parameters, const GraphBackward& how) {
  std::int64_t end = std::ssize(d_parameters);
  for (int layer = static_cast<int>(nodes_.size()) - 1; layer >= 0; --layer) {
    const Node& node = nodes_[layer];
    end -= node.parameters;
    if (layer + how.left_out >= static_cast<int>(nodes_.size())) continue;
    std::vector<BackwardPass> passes;
    for (std::size_t i = 0; i < batch.size(); ++i) {
      finish_gradient(layer + 1, batch[i], how.dropped, gradients[i]);
      passes.push_back(backward_pass(layer, batch[i], gradients[i]));
    }
    node.layer->backward(passes, d_parameters.subspan(end, node.parameters));
  }
}

void LayerGraph::last_backward_rows(const Values& values, int first_row, const Tensor& d_output,
                                    Values& gradients, std::span<float> d_parameters) {
  const auto layer = static_cast<int>(nodes_.size()) - 1;
  const int from = nodes_[layer].inputs[0];
  last_convolution_->backward_rows(values[from], first_row, d_output,
                                   input_gradient_end(layer, values, gradients), gradients[from],
                                   d_parameters.last(nodes_[layer].parameters));
}

std::vector<NetworkStep> LayerGraph::steps(Values& values, int passes) {
  std::vector<NetworkStep> steps;
  const auto layers = static_cast<int>(nodes_.size());
  const int random = first_random_layer();
  GraphForward how;
  if (passes > 1) how.seed = 0;
  for (int layer = 0; layer < layers; ++layer) {
    how.first = layer;
    how.left_out = layers - 1 - layer;
    steps.push_back({.name = nodes_[layer].name,
                     .calls = layer < random ? 1 : passes,
                     .multiply_adds = nodes_[layer].layer->multiply_adds(),
                     .run = [this, &values, how] { forward(values, how); },
                     .reference = nodes_[layer].layer->reference(pass_of(layer, values))});
  }
  return steps;
}

void drop_out(std::uint64_t seed, float share, Tensor& values) {
#pragma omp for schedule(static)
  for (int channel = 0; channel < values.channels(); ++channel) {
    for (int y = 0; y < values.rows(); ++y) {
      float* row = values.row(channel, y);
      const auto first = static_cast<std::uint64_t>(channel * values.rows() + y) * values.columns();
      for (int x = 0; x < values.columns(); ++x) {
        row[x] = unit_random(seed, first + x) < share ? 0.0F : kept_scale(share) * row[x];
      }
      values.fill_border(channel, y);
    }
  }
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

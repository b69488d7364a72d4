#include "layer_graph.h"

#include "hqslam/core/error.h"
#include "random.h"

namespace hqslam::nn {
namespace {

/// The seed of a graph's dropout 0, 1, ... A loop that runs graphs for one sample gives them seeds
/// 10 apart: those of the eleventh dropout on are elsewhere, or masks would come again.
std::uint64_t dropout_seed(std::uint64_t seed, std::uint64_t number) {
  return seed + number % 10 + ((number / 10) << 60U);
}

/// A number from 0 to below 1 for each place, whatever the order in which they are taken.
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
    nodes_[layer].layer->forward(pass_of(layer, values));
    if (how.seed) drop_out_of(layer, *how.seed, values[layer + 1]);
  }
}

void LayerGraph::drop_out_of(int layer, std::uint64_t seed, Tensor& result) const {
  const Node& node = nodes_[layer];
  if (node.dropout == 0.0F) return;
  drop_out(dropout_seed(seed, node.dropouts_before), node.dropout, result);
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

}  // namespace hqslam::nn

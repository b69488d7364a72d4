#include "layer_graph.h"

namespace hqslam::nn {

int LayerGraph::add(const std::string& name, std::unique_ptr<Layer> layer,
                    std::vector<int> inputs) {
  shapes_.push_back(layer->output_shape());
  const std::int64_t parameters = elements(layer->parameter_shapes());
  std::uint64_t random_before = 0;
  for (const Node& node : nodes_) random_before += node.layer->is_random() ? 1 : 0;
  nodes_.push_back({name, std::move(layer), std::move(inputs), parameters, random_before});
  return static_cast<int>(nodes_.size());
}

std::vector<ParameterShape> LayerGraph::parameter_shapes() const {
  std::vector<ParameterShape> shapes;
  for (const Node& node : nodes_) {
    for (ParameterShape shape : node.layer->parameter_shapes()) {
      shape.name = node.name + "." + shape.name;
      shapes.push_back(std::move(shape));
    }
  }
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

std::vector<Tensor> LayerGraph::make_values() const {
  std::vector<Tensor> values;
  for (const TensorShape& shape : shapes_) values.push_back(shape.make());
  return values;
}

LayerPass LayerGraph::pass_of(int layer, std::vector<Tensor>& values,
                              std::optional<std::uint64_t> seed) const {
  LayerPass pass{.output = &values[layer + 1]};
  for (const int input : nodes_[layer].inputs) pass.inputs.push_back(&values[input]);
  if (seed) pass.seed = *seed + nodes_[layer].random_before;
  return pass;
}

void LayerGraph::forward(std::vector<Tensor>& values, std::optional<std::uint64_t> seed,
                         int first) {
  for (int layer = first; layer < static_cast<int>(nodes_.size()); ++layer) {
    nodes_[layer].layer->forward(pass_of(layer, values, seed));
  }
}

int LayerGraph::first_random_layer() const {
  int layer = 0;
  for (const Node& node : nodes_) {
    if (node.layer->is_random()) break;
    ++layer;
  }
  return layer;
}

std::vector<NetworkStep> LayerGraph::steps(std::vector<Tensor>& values, int passes) {
  std::vector<NetworkStep> steps;
  const int random = first_random_layer();
  for (int layer = 0; layer < static_cast<int>(nodes_.size()); ++layer) {
    const std::optional<std::uint64_t> seed =
        passes > 1 ? std::optional<std::uint64_t>(0) : std::nullopt;
    NetworkStep step;
    step.name = nodes_[layer].name;
    step.calls = layer < random ? 1 : passes;
    step.multiply_adds = nodes_[layer].layer->multiply_adds();
    step.run = [this, layer, &values, seed] {
      nodes_[layer].layer->forward(pass_of(layer, values, seed));
    };
    steps.push_back(std::move(step));
  }
  return steps;
}

std::vector<LayerPass> LayerGraph::passes_of(int layer, std::span<Scan> batch) const {
  std::vector<LayerPass> passes;
  for (Scan& scan : batch) {
    LayerPass& pass = passes.emplace_back(pass_of(layer, scan.values, scan.seed));
    pass.d_output = &scan.gradients[layer + 1];
    for (const int input : nodes_[layer].inputs) pass.d_inputs.push_back(&scan.gradients[input]);
  }
  return passes;
}

void LayerGraph::forward(std::span<Scan> batch) {
  for (int layer = 0; layer < static_cast<int>(nodes_.size()); ++layer) {
    nodes_[layer].layer->forward_training(passes_of(layer, batch));
  }
}

void LayerGraph::backward(std::span<Scan> batch, std::span<float> d_parameters) {
  for (Scan& scan : batch) {
    for (std::size_t tensor = 0; tensor + 1 < scan.gradients.size(); ++tensor) {
      scan.gradients[tensor].set_zero();
    }
  }
  auto end = d_parameters.size();
  for (int layer = static_cast<int>(nodes_.size()) - 1; layer >= 0; --layer) {
    for (Scan& scan : batch) scan.gradients[layer + 1].fill_borders();
    const auto count = static_cast<std::size_t>(nodes_[layer].parameters);
    end -= count;
    nodes_[layer].layer->backward(passes_of(layer, batch), d_parameters.subspan(end, count));
  }
}

}  // namespace hqslam::nn

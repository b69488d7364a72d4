#include "layers/layers.h"

#include "golden.h"
#include "graph/graph_backward.h"

namespace hqslam::nn {
namespace {

constexpr ColumnPadding kCircular = ColumnPadding::kCircular;
constexpr ColumnPadding kZero = ColumnPadding::kZero;
constexpr double kTolerance = 1e-5;

using Shapes = std::vector<TensorShape>;

/// How a layer of the golden file is made.
struct LayerCase {
  std::string name;
  ColumnPadding padding = kCircular;
  std::function<std::unique_ptr<Layer>(const Shapes&, const Engine&)> make;
};

/// A case of a convolution.
LayerCase convolution(const std::string& name, ColumnPadding padding,
                      const ConvolutionOptions& options) {
  return {name, padding, [options](const Shapes& in, const Engine& engine) {
            return std::make_unique<ConvolutionLayer>(options, in[0], engine);
          }};
}
std::vector<LayerCase> layer_cases() {
  ConvolutionOptions transposed = three_by_three(5, 0.0F);
  transposed.stride = {2, 1};
  transposed.transposed = true;
  return {convolution("transposed", kZero, transposed),
          convolution("linear", kCircular, {.channels = 7}),
          {"batch_norm", kCircular,
           [](const Shapes& in, const Engine&) { return make_batch_norm(0.125F, in[0]); }},
          {"average_pool", kZero,
           [](const Shapes& in, const Engine&) { return make_average_pool(in[0]); }},
          {"concatenation", kCircular,
           [](const Shapes& in, const Engine&) { return make_concatenation(in[0], in[1]); }}};
}

std::vector<float> values_of(const std::vector<Tensor>& scans) {
  std::vector<float> all;
  for (const Tensor& scan : scans) {
    const std::vector<float> values = nn::values_of(scan);
    all.insert(all.end(), values.begin(), values.end());
  }
  return all;
}

/// A batch and all that a layer makes of it.
struct Batch {
  Engine engine;
  std::unique_ptr<Layer> layer;
  std::vector<std::vector<Tensor>> inputs;  ///< input, scan
  std::vector<std::vector<Tensor>> d_inputs;
  std::vector<Tensor> d_output;
  std::vector<Tensor> output;
  std::vector<float> parameters;
  std::vector<float> d_parameters;

  std::vector<LayerPass> passes() {
    std::vector<LayerPass> all;
    for (std::size_t scan = 0; scan < output.size(); ++scan) {
      all.push_back(
          {&inputs[0][scan], inputs.size() > 1 ? &inputs[1][scan] : nullptr, &output[scan]});
    }
    return all;
  }
  /// From gradients of zero, and from that of the result on.
  void backward() {
    std::vector<Tensor> before = d_output;  // of what went into the activation
    std::vector<BackwardPass> all;
    for (std::size_t scan = 0; scan < output.size(); ++scan) {
      leaky_relu_backward(layer->negative_slope(), output[scan], before[scan]);
      all.push_back(
          {.input = &inputs[0][scan], .d_output = &before[scan], .d_input = &d_inputs[0][scan]});
      if (inputs.size() > 1) all.back().d_second = &d_inputs[1][scan];
    }
    if (auto* convolution = dynamic_cast<ConvolutionLayer*>(layer.get())) {
      ConvolutionBackward of_convolution(*convolution, engine);
      of_convolution.set_parameters(parameters);
      of_convolution.backward(all, d_parameters);
    } else {
      dynamic_cast<LayerBackward&>(*layer).backward(all, d_parameters);
    }
  }
  void forward() {
    layer->set_parameters(parameters);
    if (auto* trainable = dynamic_cast<TrainableLayer*>(layer.get())) {
      trainable->forward_batch(passes());
    } else {
      for (const LayerPass& pass : passes()) layer->forward(pass);
    }
  }
};

Batch golden_batch(const Golden& golden, const LayerCase& c, const Engine& engine) {
  Batch batch;
  batch.engine = engine;
  std::vector<TensorShape> shapes;
  for (int i = 0; golden.has(fmt::format("{}.input.{}", c.name, i)); ++i) {
    batch.inputs.push_back(scans_of(golden, fmt::format("{}.input.{}", c.name, i), c.padding));
    shapes.push_back(shape_of(batch.inputs.back().front()));
  }
  batch.d_inputs = batch.inputs;
  for (std::vector<Tensor>& d_input : batch.d_inputs) {
    for (Tensor& scan : d_input) scan.set_zero();
  }
  batch.d_output = scans_of(golden, c.name + ".d_output", c.padding);
  batch.layer = c.make(shapes, engine);
  if (golden.has(c.name + ".parameters")) {
    batch.parameters = golden.values(c.name + ".parameters");
    batch.d_parameters.resize(batch.parameters.size());
  }
  batch.output.assign(batch.d_output.size(), batch.layer->output_shape().make());
  return batch;
}

}  // namespace

TEST_CASE("each layer and its gradients equal PyTorch's with every instruction set") {
  const Golden golden("network_layers");
  for (const LayerCase& c : layer_cases()) {
    for (const InstructionSet instruction_set : available_instruction_sets()) {
      CAPTURE(c.name);
      CAPTURE(name(instruction_set));
      Batch batch = golden_batch(golden, c, {instruction_set, 1});
      batch.forward();
      batch.backward();
      CHECK(relative_error(std::span<const float>(values_of(batch.output)),
                           golden.values(c.name + ".output")) < kTolerance);
      for (std::size_t i = 0; i < batch.inputs.size(); ++i) {
        CHECK(relative_error(std::span<const float>(values_of(batch.d_inputs[i])),
                             golden.values(fmt::format("{}.d_input.{}", c.name, i))) < kTolerance);
      }
      if (batch.parameters.empty()) continue;
      CHECK(relative_error(std::span<const float>(batch.d_parameters),
                           golden.values(c.name + ".d_parameters")) < kTolerance);
      CHECK(elements(batch.layer->parameter_shapes()) ==
            static_cast<std::int64_t>(batch.parameters.size()));
    }
  }
}

TEST_CASE("batch norm upsamples with its running statistics") {
  const Golden golden("network_layers");
  const std::vector<LayerCase> all = layer_cases();
  Batch batch = golden_batch(golden, *std::ranges::find(all, "batch_norm", &LayerCase::name), {});
  batch.layer->set_parameters(batch.parameters);
  for (const LayerPass& pass : batch.passes()) batch.layer->forward(pass);
  CHECK(relative_error(std::span<const float>(values_of(batch.output)),
                       golden.values("batch_norm.upsampled")) < kTolerance);
}

}  // namespace hqslam::nn

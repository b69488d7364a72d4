#include "layers/layers.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "golden.h"
#include "hqslam/core/error.h"
#include "graph/layer_graph.h"
#include "random_values.h"

namespace hqslam::nn {
namespace {

constexpr ColumnPadding kCircular = ColumnPadding::kCircular;
constexpr ColumnPadding kZero = ColumnPadding::kZero;
constexpr double kTolerance = 1e-5;

/// How a layer of the golden file is made.
struct Case {
  std::string name;
  ColumnPadding padding = kCircular;
  std::function<std::unique_ptr<Layer>(const std::vector<TensorShape>&, const Engine&)> make;
  std::optional<std::uint64_t> seed = std::nullopt;
};

ConvolutionOptions three_by_three(int channels) {
  return {.channels = channels,
          .kernel_rows = 3,
          .kernel_columns = 3,
          .padding_rows = 1,
          .padding_columns = 1,
          .negative_slope = 0.0F};
}

std::vector<Case> cases() {
  using Tensors = std::vector<TensorShape>;
  std::vector<Case> all;
  all.push_back({"transposed", kZero, [](const Tensors& in, const Engine& engine) {
                   ConvolutionOptions options = three_by_three(5);
                   options.stride_rows = 2;
                   options.transposed = true;
                   return make_convolution(options, in[0], engine);
                 }});
  all.push_back({"linear", kCircular, [](const Tensors& in, const Engine& engine) {
                   return make_convolution({.channels = 7, .linear = true}, in[0], engine);
                 }});
  all.push_back(
      {"patch_embedding", kCircular, [](const Tensors& in, const Engine& engine) {
         return make_convolution(
             {.channels = 6, .kernel_columns = 8, .stride_columns = 4, .padding_columns = 2}, in[0],
             engine);
       }});
  all.push_back({"batch_norm", kCircular, [](const Tensors& in, const Engine&) {
                   return make_batch_norm(1e-3F, 0.125F, in[0]);
                 }});
  all.push_back({"average_pool", kZero,
                 [](const Tensors& in, const Engine&) { return make_average_pool(in[0]); }});
  all.push_back({"concatenation", kCircular, [](const Tensors& in, const Engine&) {
                   return make_concatenation(in[0], in[1]);
                 }});
  all.push_back({"dropout", kCircular,
                 [](const Tensors& in, const Engine&) { return make_dropout(0.25F, in[0]); }, 77});
  all.push_back({"layer_norm", kCircular,
                 [](const Tensors& in, const Engine&) { return make_layer_norm(1e-6F, in[0]); }});
  all.push_back({"gelu", kCircular,
                 [](const Tensors& in, const Engine& engine) { return make_gelu(in[0], engine); }});
  all.push_back({"attention", kCircular, [](const Tensors& in, const Engine& engine) {
                   return make_window_attention({.heads = 2}, in[0], engine);
                 }});
  all.push_back({"attention.shifted", kCircular, [](const Tensors& in, const Engine& engine) {
                   return make_window_attention({.heads = 2, .shifted = true}, in[0], engine);
                 }});
  all.push_back({"attention.circular", kCircular, [](const Tensors& in, const Engine& engine) {
                   return make_window_attention({.heads = 2, .shifted = true, .circular = true},
                                                in[0], engine);
                 }});
  all.push_back({"patch_merging", kCircular,
                 [](const Tensors& in, const Engine&) { return make_patch_merging(in[0]); }});
  all.push_back({"pixel_shuffle", kCircular,
                 [](const Tensors& in, const Engine&) { return make_pixel_shuffle(3, in[0]); }});
  return all;
}

TensorShape shape_of(const Tensor& tensor) {
  return {tensor.channels(), tensor.rows(), tensor.columns(), tensor.padding()};
}

/// An array of scans x channels x rows x columns.
std::vector<Tensor> scans_of(const Golden& golden, const std::string& name, ColumnPadding padding) {
  const std::vector<std::int64_t>& shape = golden.array(name).shape;
  const std::vector<float> values = golden.values(name);
  const std::size_t each = values.size() / shape.at(0);
  std::vector<Tensor> scans;
  for (std::int64_t scan = 0; scan < shape.at(0); ++scan) {
    scans.push_back(tensor_of(std::span(values).subspan(scan * each, each),
                              static_cast<int>(shape.at(1)), static_cast<int>(shape.at(2)),
                              static_cast<int>(shape.at(3)), padding));
  }
  return scans;
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
  std::unique_ptr<Layer> layer;
  std::vector<std::vector<Tensor>> inputs;  ///< input, scan
  std::vector<std::vector<Tensor>> d_inputs;
  std::vector<Tensor> d_output;
  std::vector<Tensor> output;
  std::vector<float> parameters;
  std::vector<float> d_parameters;
  std::optional<std::uint64_t> seed;

  std::vector<LayerPass> passes() {
    std::vector<LayerPass> all;
    for (std::size_t scan = 0; scan < output.size(); ++scan) {
      LayerPass& pass = all.emplace_back(
          LayerPass{.output = &output[scan], .seed = seed, .d_output = &d_output[scan]});
      for (const std::vector<Tensor>& input : inputs) pass.inputs.push_back(&input[scan]);
      for (std::vector<Tensor>& d_input : d_inputs) pass.d_inputs.push_back(&d_input[scan]);
    }
    return all;
  }
  /// The sum of outputs times d_output.
  double loss() {
    for (std::vector<Tensor>& input : inputs) {
      for (Tensor& scan : input) scan.fill_borders();
    }
    layer->set_parameters(parameters);
    layer->forward_training(passes());
    const std::vector<float> values = values_of(output);
    const std::vector<float> factors = values_of(d_output);
    double sum = 0.0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      sum += static_cast<double>(values[i]) * factors[i];
    }
    return sum;
  }
};

Batch golden_batch(const Golden& golden, const Case& c, const Engine& engine) {
  Batch batch;
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
  batch.seed = c.seed;
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
  for (const Case& c : cases()) {
    for (const InstructionSet instruction_set : available_instruction_sets()) {
      CAPTURE(c.name);
      CAPTURE(name(instruction_set));
      Batch batch = golden_batch(golden, c, {instruction_set, 1});
      batch.loss();
      batch.layer->backward(batch.passes(), batch.d_parameters);
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

TEST_CASE("gradients are what small changes of inputs and parameters do") {
  constexpr float kStep = 1.0F / 1024.0F;
  const Golden golden("network_layers");
  for (const Case& c : cases()) {
    CAPTURE(c.name);
    Batch batch = golden_batch(golden, c, {});
    batch.loss();
    batch.layer->backward(batch.passes(), batch.d_parameters);
    const auto slope_at = [&](float& value) {
      const float before = value;
      value = before + kStep;
      const double above = batch.loss();
      value = before - kStep;
      const double below = batch.loss();
      value = before;
      return (above - below) / (2.0 * kStep);
    };
    for (std::size_t input = 0; input < batch.inputs.size(); ++input) {
      Tensor& x = batch.inputs[input].front();
      for (const int column : {0, 7, 13}) {
        CHECK(slope_at(x.at(1 % x.channels(), 1, column)) ==
              doctest::Approx(batch.d_inputs[input].front().at(1 % x.channels(), 1, column))
                  .epsilon(0.02)
                  .scale(2));
      }
    }
    // Running statistics have no gradient in this sense.
    const std::size_t learned = batch.parameters.size() / (c.name == "batch_norm" ? 2 : 1);
    for (std::size_t i = 0; i < learned; i += 1 + learned / 7) {
      CHECK(slope_at(batch.parameters[i]) ==
            doctest::Approx(batch.d_parameters[i]).epsilon(0.02).scale(5));
    }
  }
}

TEST_CASE("one and two threads give the same bits in every layer") {
  const Golden golden("network_layers");
  for (const Case& c : cases()) {
    CAPTURE(c.name);
    Batch one = golden_batch(golden, c, {chosen_instruction_set(), 1});
    Batch two = golden_batch(golden, c, {chosen_instruction_set(), 2});
    one.layer->set_parameters(one.parameters);
    two.layer->set_parameters(two.parameters);
    one.layer->forward(one.passes().front());
    const LayerPass pass = two.passes().front();
#pragma omp parallel num_threads(2)
    two.layer->forward(pass);
    CHECK(same_bits(one.output.front(), two.output.front()));
  }
}

TEST_CASE("batch norm lifts with its running statistics") {
  const Golden golden("network_layers");
  const std::vector<Case> all = cases();
  const auto c = std::find_if(all.begin(), all.end(),
                              [](const Case& each) { return each.name == "batch_norm"; });
  Batch batch = golden_batch(golden, *c, {});
  batch.layer->set_parameters(batch.parameters);
  for (const LayerPass& pass : batch.passes()) batch.layer->forward(pass);
  CHECK(relative_error(std::span<const float>(values_of(batch.output)),
                       golden.values("batch_norm.lifted")) < kTolerance);
}

TEST_CASE("a convolution with the batch norm behind it worked into its weights gives the same") {
  const Golden golden("network_layers");
  for (const bool transposed : {false, true}) {
    ConvolutionOptions options = three_by_three(3);
    options.transposed = transposed;
    if (transposed) options.stride_rows = options.stride_columns = 2;
    const Case c{transposed ? "normalised.1" : "normalised.0", kZero,
                 [&](const std::vector<TensorShape>& in, const Engine& engine) {
                   return make_normalised_convolution(options, 1e-3F, in[0], engine);
                 }};
    Batch batch = golden_batch(golden, c, {});
    batch.loss();
    CHECK(relative_error(std::span<const float>(values_of(batch.output)),
                         golden.values(c.name + ".output")) < kTolerance);
    CHECK(batch.layer->parameter_shapes().back().name == "norm.running_var");
  }
}

TEST_CASE("without a seed nothing is dropped, and another seed drops others") {
  Tensor input(4, 8, 32, kCircular);
  fill_random(1, input);
  const std::unique_ptr<Layer> layer = make_dropout(0.25F, shape_of(input));
  Tensor first = input;
  Tensor second = input;
  layer->forward({.inputs = {&input}, .output = &first});
  CHECK(same_bits(input, first));
  layer->forward({.inputs = {&input}, .output = &first, .seed = 1});
  layer->forward({.inputs = {&input}, .output = &second, .seed = 2});
  CHECK_FALSE(same_bits(first, second));
  const std::vector<float> values = nn::values_of(first);
  const auto dropped = std::count(values.begin(), values.end(), 0.0F);
  CHECK(static_cast<double>(dropped) / static_cast<double>(values.size()) ==
        doctest::Approx(0.25).epsilon(0.1));
}

TEST_CASE("windows that do not divide the image are refused") {
  const TensorShape input{12, 3, 16, kCircular};
  CHECK_THROWS_AS(make_window_attention({.heads = 2}, input, {}), Error);
}

TEST_CASE("a tensor that two layers use gets the sum of both gradients") {
  const TensorShape input{1, 2, 16, kCircular};
  LayerGraph graph(input);
  const ConvolutionOptions linear{.channels = 1, .bias = false, .linear = true};
  const int once = graph.add("once", make_convolution(linear, input, {}), {0});
  graph.add("sum", make_convolution(linear, input, {}), {once, 0});
  CHECK(graph.parameter_shapes().front().name == "once.weight");
  graph.set_parameters(std::vector<float>{3.0F, 5.0F});
  std::vector<LayerGraph::Scan> batch{{graph.make_values(), graph.make_values(), std::nullopt}};
  fill_random(1, batch[0].values[0]);
  Tensor& d_output = batch[0].gradients.back();
  for (int x = 0; x < 16; ++x) d_output.at(0, 1, x) = 1.0F;
  std::vector<float> d_parameters(2);
  graph.forward(batch);
  graph.backward(batch, d_parameters);
  CHECK(batch[0].values.back().at(0, 1, 4) ==
        doctest::Approx(16.0F * batch[0].values[0].at(0, 1, 4)));
  CHECK(batch[0].gradients[0].at(0, 1, 4) == 16.0F);  // 5 * 3 + 1
  CHECK(batch[0].gradients[0].at(0, 0, 4) == 0.0F);
}

}  // namespace hqslam::nn

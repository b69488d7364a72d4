#include "golden.h"
#include "graph/graph_backward.h"

namespace hqslam::nn {

TEST_CASE("a graph's gradients are what small changes of input and parameters do") {
  constexpr float kStep = 1.0F / 16384.0F;  // few ReLUs turn within it
  constexpr std::uint64_t kSeed = 5;
  // With dropout, skips (one of them from the layer's own input), a stride and back, a row bias.
  LayerGraph graph({3, 4, 32}, {chosen_instruction_set(), 1});
  ConvolutionOptions first = three_by_three(5, 0.0F);
  first.row_bias = true;
  const int wide = graph.add("wide", first, {0});
  const int narrow = graph.add("narrow", three_by_three(6, 0.0F, 2), {wide}, 0.25F);
  const int residual = graph.add("residual", three_by_three(6, 0.125F), {narrow, narrow});
  const int back = graph.add("back",
                             {.channels = 5,
                              .kernel = {2, 2},
                              .stride = {2, 2},
                              .transposed = true,
                              .negative_slope = 0.125F},
                             {residual, wide});
  graph.add("head", {.channels = 2}, {back});
  GraphBackward backward(graph);
  std::vector<float> parameters = graph.initial_parameters(3);
  for (float& parameter : parameters) parameter *= 2.0F;
  std::vector<LayerGraph::Values> values{graph.make_values()};
  std::vector<LayerGraph::Values> gradients{graph.make_values()};
  fill_random(1, values[0].front());
  Tensor d_output = values[0].back();
  fill_random(2, d_output);
  const auto loss = [&] {
    values[0].front().fill_borders();
    graph.set_parameters(parameters);
    backward.set_parameters(parameters);
    backward.forward_batch(values, std::vector<std::uint64_t>{kSeed});
    double sum = 0.0;
    const std::vector<float> factors = values_of(d_output);
    const std::vector<float> results = values_of(values[0].back());
    for (std::size_t i = 0; i < results.size(); ++i) {
      sum += static_cast<double>(results[i]) * factors[i];
    }
    return sum;
  };
  loss();
  std::vector<float> d_parameters(parameters.size());
  gradients[0].back() = d_output;
  backward.backward(values, gradients, d_parameters, {.dropped = true});
  const auto slope_at = [&](float& value) { return slope_of(loss, kStep, value); };
  for (std::size_t i = 0; i < parameters.size(); i += 37) {
    CAPTURE(i);
    CHECK(slope_at(parameters[i]) == doctest::Approx(d_parameters[i]).epsilon(0.02).scale(2));
  }
  for (const int column : {0, 9, 31}) {
    CHECK(slope_at(values[0].front().at(1, 2, column)) ==
          doctest::Approx(gradients[0].front().at(1, 2, column)).epsilon(0.02).scale(2));
  }
}

TEST_CASE("no mask of a dropout comes again in a graph whose seed is 10 more") {
  LayerGraph graph({1, 4, 32}, {});
  constexpr int kDropouts = 12;
  for (int i = 0; i < kDropouts; ++i) graph.add("same", {.bias = false}, {0}, 0.5F);
  graph.set_parameters(std::vector<float>(kDropouts, 1.0F));
  std::vector<LayerGraph::Values> values(2, graph.make_values());
  for (LayerGraph::Values& of_seed : values) {
    for (int y = 0; y < 4; ++y) std::fill_n(of_seed[0].row(0, y), 32, 1.0F);
  }
  GraphBackward(graph).forward_batch(values, std::vector<std::uint64_t>{1000, 1010});
  for (int a = 1; a <= kDropouts; ++a) {
    for (int b = 1; b <= kDropouts; ++b) CHECK_FALSE(same_bits(values[0][a], values[1][b]));
  }
}

TEST_CASE("a sum of tensors of different shapes is refused") {
  LayerGraph graph({1, 5, 16}, {});
  const int half = graph.add("half", three_by_three(2, 1.0F, 2), {0});
  const ConvolutionOptions back{
      .channels = 1, .kernel = {2, 2}, .stride = {2, 2}, .transposed = true};
  const std::vector<int> summands = {half, 0};
  CHECK(refused_with([&] { graph.add("back", back, summands); }, "'back'", "1 x 5 x 16",
                     "1 x 6 x 16"));
}

TEST_CASE("dropout and its gradient equal PyTorch's, and another seed drops others") {
  const Golden golden("network_layers");
  const auto tensor = [&](const std::string& name) { return scans_of(golden, name).front(); };
  const Tensor input = tensor("dropout.input.0");
  Tensor dropped = input;
  drop_out(77, 0.25F, dropped);
  CHECK(relative_error(dropped, values_of(tensor("dropout.output"))) < 1e-6);
  Tensor gradient = tensor("dropout.d_output");
  drop_out_backward(0.25F, dropped, gradient);
  CHECK(relative_error(gradient, values_of(tensor("dropout.d_input.0"))) < 1e-6);
  Tensor other = input;
  drop_out(78, 0.25F, other);
  CHECK_FALSE(same_bits(dropped, other));
  Tensor large(4, 8, 32, ColumnPadding::kCircular);
  fill_random(1, large);
  drop_out(1, 0.25F, large);
  const std::vector<float> values = values_of(large);
  const auto zeros = std::ranges::count(values, 0.0F);
  CHECK(static_cast<double>(zeros) / static_cast<double>(values.size()) ==
        doctest::Approx(0.25).epsilon(0.1));
}

TEST_CASE("the gradients of ReLU and leaky ReLU equal PyTorch's; at 0 they are slope x gradient") {
  const Golden golden("layers");
  for (const auto& [slope, name] :
       {std::pair(0.0F, std::string("leaky_relu.0.0")), {0.125F, "leaky_relu.0.125"}}) {
    Tensor gradient = tensor_of(golden.values(name + ".d_output"), 2, 3, 20);
    leaky_relu_backward(slope, tensor_of(golden.values(name + ".output"), 2, 3, 20), gradient);
    CHECK(relative_error(gradient, golden.values(name + ".d_input")) < 1e-6);
    CHECK(gradient.at(1, 2, -1) == gradient.at(1, 2, 19));
    CHECK(gradient.at(1, 2, 20) == gradient.at(1, 2, 0));
  }
  Tensor gradient = tensor_of(std::vector(3, 8.0F), 1, 1, 3);
  leaky_relu_backward(0.25F, tensor_of(std::vector{-0.5F, 0.0F, 4.0F}, 1, 1, 3), gradient);
  CHECK(values_of(gradient) == std::vector<float>{2.0F, 2.0F, 8.0F});
}

}  // namespace hqslam::nn

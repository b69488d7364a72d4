#include "plain_denoiser.h"

#include <fmt/format.h>

#include "../graph/layer_graph.h"
#include "../parameters.h"
#include "channels.h"
#include "hqslam/core/error.h"

namespace hqslam::nn {
namespace {

LayerGraph plain_graph(const PlainDenoiserShape& shape, int rows, int columns,
                       const Engine& engine) {
  LayerGraph graph({1, rows, columns, ColumnPadding::kZero}, engine);
  for (int i = 0; i < shape.convolutions; ++i) {
    const bool last = i + 1 == shape.convolutions;
    ConvolutionOptions options = three_by_three(last ? 1 : shape.features, last ? 1.0F : 0.0F);
    options.bias = false;
    graph.add(fmt::format("convolution.{}", i), options, {i}, last ? 0.0F : shape.dropout);
  }
  return graph;
}

class PlainDenoiser final : public Denoiser {
 public:
  explicit PlainDenoiser(LayerGraph graph) : graph_(std::move(graph)) {}

  TileSize tile() const override { return {}; }
  ColumnPadding padding() const override { return ColumnPadding::kZero; }
  int memory_channels() const override { return 0; }
  std::vector<ParameterShape> parameter_shapes() const override {
    return graph_.parameter_shapes();
  }
  std::vector<float> initial_parameters(std::uint64_t seed) const override {
    return graph_.initial_parameters(seed);
  }
  std::int64_t multiply_adds() const override { return graph_.multiply_adds(); }
  DenoiserState make_state(bool /*for_backward*/) const override {
    std::vector<Tensor> values = graph_.make_values();
    Tensor z = values.back();
    return {std::move(values), std::move(z)};
  }
  void set_parameters(std::span<const float> parameters) override {
    graph_.set_parameters(parameters);
  }
  void forward(const Candidates& /*candidates*/, DenoiserState& state,
               std::optional<std::uint64_t> dropout_seed) override {
    graph_.forward(state.values, {.seed = dropout_seed});
    copy_channels(state.output(), 0, 1, state.z, 0);
#pragma omp master
    dropped_out_ = dropout_seed.has_value();
  }
  void backward(const Candidates& /*candidates*/, const DenoiserState& state,
                DenoiserState& gradient, std::span<float> d_parameters) override {
    gradient.output() = gradient.z;
    gradient.output().fill_borders();
    graph_.backward({&state.values, 1}, {&gradient.values, 1}, d_parameters,
                    {.dropped = dropped_out_});
  }
  std::vector<NetworkStep> steps(const Candidates& /*candidates*/, DenoiserState& state) override {
    return graph_.steps(state.values);
  }

 private:
  LayerGraph graph_;
  bool dropped_out_ = false;
};

void validate(const PlainDenoiserShape& shape) {
  constexpr int kMostFeatures = 512;
  constexpr int kMostConvolutions = 20;
  check_field("features", shape.features, 1, kMostFeatures);
  check_field("convolutions", shape.convolutions, 2, kMostConvolutions);
  if (!(shape.dropout >= 0.0F && shape.dropout < 1.0F)) {
    throw Error(fmt::format("denoiser: dropout is {}, expected 0 to below 1", shape.dropout));
  }
}

}  // namespace

DenoiserDescription plain_denoiser(const PlainDenoiserShape& shape) {
  validate(shape);
  return {"plain",
          {{"features", shape.features},
           {"convolutions", shape.convolutions},
           {"dropout", shape.dropout}},
          {1, 1},
          [shape](int rows, int columns, InstructionSet instruction_set, int threads) {
            return std::make_unique<PlainDenoiser>(
                plain_graph(shape, rows, columns, {instruction_set, threads}));
          }};
}

DenoiserDescription read_plain_denoiser(JsonFields& sizes) {
  PlainDenoiserShape shape;
  sizes.optional("features", shape.features);
  sizes.optional("convolutions", shape.convolutions);
  sizes.optional("dropout", shape.dropout);
  return plain_denoiser(shape);
}

}  // namespace hqslam::nn

#include "plain_prior.h"

#include <fmt/format.h>

#include "hqslam/core/error.h"
#include "parameters.h"

namespace hqslam::nn {
namespace {

LayerGraph plain_graph(const PlainPriorShape& shape, int rows, int columns, const Engine& engine) {
  LayerGraph graph({1, rows, columns, ColumnPadding::kZero}, engine);
  for (int i = 0; i < shape.convolutions; ++i) {
    const bool last = i + 1 == shape.convolutions;
    ConvolutionOptions options = three_by_three(last ? 1 : shape.features, last ? 1.0F : 0.0F);
    options.bias = false;
    graph.add(fmt::format("convolution.{}", i), options, {i}, last ? 0.0F : shape.dropout);
  }
  return graph;
}

void validate(const PlainPriorShape& shape) {
  constexpr int kMostFeatures = 512;
  constexpr int kMostConvolutions = 20;
  check_field("features", shape.features, 1, kMostFeatures);
  check_field("convolutions", shape.convolutions, 2, kMostConvolutions);
  check_that(shape.dropout >= 0.0F && shape.dropout < 1.0F, "denoiser", "dropout", shape.dropout,
             "0 to below 1");
}

}  // namespace

void PlainPrior::forward(const Candidates& /*candidates*/, PriorState& state,
                         const PriorPass& pass) {
  graph_.forward(state.values, {.seed = pass.dropout_seed});
  copy_channels(state.output(), 0, 1, state.z, 0);
#pragma omp master
  dropped_out_ = pass.dropout_seed.has_value();
}

PriorDescription plain_prior(const PlainPriorShape& shape) {
  validate(shape);
  return {
      .sizes = {{"features", shape.features},
                {"convolutions", shape.convolutions},
                {"dropout", shape.dropout}},
      .graph = [shape](int rows, int columns,
                       const Engine& engine) { return plain_graph(shape, rows, columns, engine); },
      .make = [](LayerGraph graph, const NetworkDescription&, int,
                 const Engine&) { return std::make_unique<PlainPrior>(std::move(graph)); }};
}

PriorDescription read_plain_prior(JsonFields& sizes) {
  PlainPriorShape shape;
  sizes.optional("features", shape.features);
  sizes.optional("convolutions", shape.convolutions);
  sizes.optional("dropout", shape.dropout);
  return plain_prior(shape);
}

}  // namespace hqslam::nn

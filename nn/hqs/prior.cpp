#include "prior.h"

#include <cmath>

#include "hqslam/core/error.h"
#include "parameters.h"

namespace hqslam::nn {

Prior::Prior(LayerGraph graph, TileSize tile) : graph_(std::move(graph)), tile_(tile) {}

void Prior::set_parameters(std::span<const float> parameters) {
  if (!beams_) {
    graph_.set_parameters(parameters);
    return;
  }
  check_parameters(parameters, beams_->shapes());
  graph_.set_parameters(beams_->of_graph(parameters));
}

std::int64_t Prior::parameters() const { return elements(parameter_shapes()); }

PriorState Prior::make_state(bool /*for_backward*/) const {
  return {graph_.make_values(), make_tiles()};
}

void Prior::add_inner(const Measurement& /*measurement*/, const PriorState& state,
                      const std::string& prefix, Trace& trace) const {
  for (std::size_t i = 1; i + 1 < state.values.size(); ++i) {
    trace.add(traced(prefix + graph_.name_of(static_cast<int>(i)), state.values[i]));
  }
}

void check_image(const PriorDescription& prior, int rows, int columns) {
  const TileSize multiple = prior.multiple;
  if (rows % multiple.rows != 0 || columns % multiple.columns != 0) {
    throw Error(
        "denoiser: an image of {} x {}, expected multiples of {} x {}; smaller tile_rows or "
        "tile_columns of network.denoiser make these smaller",
        rows, columns, multiple.rows, multiple.columns);
  }
}

LayerGraph graph_of(const PriorDescription& prior, const NetworkDescription& network) {
  return prior.graph(network.sensor.rows(), network.sensor.columns, {InstructionSet::kPortable, 1});
}

namespace {

std::optional<BeamParameters> beams_of(const PriorDescription& prior, const NetworkDescription& d,
                                       const LayerGraph& graph) {
  if (prior.any_beams == TileSize{}) return std::nullopt;
  return BeamParameters(d.sensor, d.measured_rows, prior.any_beams, graph.parameter_shapes());
}

}  // namespace

std::vector<ParameterShape> parameter_shapes(const PriorDescription& prior,
                                             const NetworkDescription& d) {
  const LayerGraph graph = graph_of(prior, d);
  const std::optional<BeamParameters> beams = beams_of(prior, d, graph);
  return beams ? beams->shapes() : graph.parameter_shapes();
}

std::vector<float> initial_parameters(const PriorDescription& prior, const NetworkDescription& d,
                                      std::uint64_t seed) {
  const LayerGraph graph = graph_of(prior, d);
  std::vector<float> values = graph.initial_parameters(seed);
  if (prior.start) prior.start(values);
  const std::optional<BeamParameters> beams = beams_of(prior, d, graph);
  return beams ? beams->start(values) : values;
}

TracedTensor traced(std::string name, const Tensor& tensor, int first, int channels) {
  if (channels == 0) channels = tensor.channels() - first;
  using Index = Eigen::array<Eigen::Index, 3>;
  const auto all = tensor.with_borders();  // rows x channels x columns
  return {std::move(name), "",
          all.slice(Index{tensor.border_rows(), first, Tensor::kBorderColumns},
                    Index{tensor.rows(), channels, tensor.columns()})
              .shuffle(Index{1, 0, 2})};
}

TracedTensor traced_pixels(std::string name, const Tensor& tensor, int first, TileSize tile) {
  RangeImage image(tensor.rows() * tile.rows, tensor.columns() * tile.columns);
  from_tiles(tensor, tile, image.range_m.data(), first);
  return traced_image(std::move(name), image, "");
}

}  // namespace hqslam::nn

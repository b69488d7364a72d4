#include "prior.h"

#include <fmt/format.h>

#include "../parameters.h"
#include "../traced.h"
#include "hqslam/core/error.h"
#include "l1_loss.h"

namespace hqslam::nn {

Prior::Prior(LayerGraph graph, TileSize tile) : graph_(std::move(graph)), tile_(tile) {}

std::int64_t Prior::parameters() const { return elements(parameter_shapes()); }

PriorState Prior::make_state(bool /*for_backward*/) const {
  PriorState state{graph_.make_values(), {}};
  state.z = Tensor(tile_.pixels(), state.input().rows(), state.input().columns(), padding());
  return state;
}

double Prior::loss(const PriorState& state, const LossTarget& target, PriorState& gradient) const {
  return l1_loss(state.z, target.truth, tile_, target.restored_rows, target.share, gradient.z);
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
    throw Error(fmt::format("denoiser: an image of {} x {}, expected multiples of {} x {}", rows,
                            columns, multiple.rows, multiple.columns));
  }
}

std::unique_ptr<Prior> make_prior(const PriorDescription& prior, const NetworkDescription& network,
                                  int rows, int columns, const Engine& engine) {
  check_image(prior, rows, columns);
  return prior.make(network, rows, columns, engine);
}

std::unique_ptr<Prior> smallest_prior(const PriorDescription& prior,
                                      const NetworkDescription& network) {
  const int rows = prior.has_rows ? network.sensor.rows() : prior.multiple.rows;
  return prior.make(network, rows, prior.multiple.columns, {InstructionSet::kPortable, 1});
}

}  // namespace hqslam::nn

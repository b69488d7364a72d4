#include "prior.h"

#include <cmath>

#include "../parameters.h"
#include "hqslam/core/error.h"

namespace hqslam::nn {

Prior::Prior(LayerGraph graph, TileSize tile) : graph_(std::move(graph)), tile_(tile) {}

std::int64_t Prior::parameters() const { return elements(parameter_shapes()); }

PriorState Prior::make_state(bool /*for_backward*/) const {
  return {graph_.make_values(), make_tiles()};
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
    throw Error(
        "denoiser: an image of {} x {}, expected multiples of {} x {}; smaller tile_rows or "
        "tile_columns of network.denoiser make these smaller",
        rows, columns, multiple.rows, multiple.columns);
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

double l1_loss(const Tensor& z, const Tensor& truth, TileSize tile,
               std::optional<RowSelection> restored_rows, float share, Tensor& d_z) {
  const double pixels = static_cast<double>(tile.pixels()) * z.rows() * z.columns();
  const auto weight = static_cast<float>(share / pixels);
  double sum = 0.0;
  for (int channel = 0; channel < tile.pixels(); ++channel) {
    for (int row = 0; row < z.rows(); ++row) {
      float* gradient = d_z.row(channel, row);
      if (restored_rows && measured(tile, *restored_rows, channel, row)) {
        for (int x = 0; x < z.columns(); ++x) gradient[x] = 0.0F;
        continue;
      }
      const float* z_row = z.row(channel, row);
      const float* truth_row = truth.row(channel, row);
      float row_sum = 0.0F;
#pragma omp simd reduction(+ : row_sum)
      for (int x = 0; x < z.columns(); ++x) {
        const float difference = z_row[x] - truth_row[x];
        row_sum += std::fabs(difference);
        gradient[x] = difference > 0.0F ? weight : (difference < 0.0F ? -weight : 0.0F);
      }
      sum += row_sum;
    }
  }
  return sum / pixels;
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

#include "unrolled_lifter.h"

#include "l1_loss.h"
#include "result.h"

namespace hqslam::nn {

UnrolledLifter::UnrolledLifter(const NetworkDescription& description, int columns,
                               InstructionSet instruction_set, int threads)
    : network_(description, columns, instruction_set, threads),
      threads_(threads),
      state_(network_.make_state(UnrolledNetwork::Kept::kLastTwo)) {}

void UnrolledLifter::set_parameters(std::span<const float> parameters) {
  network_.set_parameters(parameters);
}

const LiftedImage& UnrolledLifter::lift(const RangeImage& measured, float /*tolerance_m*/) {
  network_.start(measured, state_);
  network_.forward(state_);
  const NetworkDescription& d = network_.description();
  lifted_.image = restored_image(d, network_.tile(), network_.result(state_), measured, threads_);
  return lifted_;
}

RangeImage UnrolledLifter::in_metres(const Tensor& tiles) const {
  RangeImage image(network_.rows(), network_.columns());
  from_tiles(tiles, network_.tile(), image.range_m.data());
  for (float& range_m : image.range_m) range_m *= network_.description().range_scale_m;
  return image;
}

LayerTrace UnrolledLifter::layer_trace(const UnrolledState& all, int layer,
                                       const RangeImage& measured) const {
  const LayerState& from = all.layer(layer);
  const NetworkDescription& d = network_.description();
  const bool has_filter = network_.options().auxiliaries == Auxiliaries::kZAndY;
  LayerTrace trace;
  trace.h = in_metres(from.denoiser.input());
  trace.z = in_metres(from.denoiser.z);
  trace.y = in_metres(has_filter ? from.y : from.denoiser.z);
  if (has_filter) trace.rejected = from.rejected;
  trace.filtered = network_.options().filtered;
  trace.rejected_pixel = network_.options().rejected;
  trace.penalty = network_.penalty(layer);
  const RowSelection rows = d.measured_rows;
  ObjectiveTerms& terms = trace.objective;
  for (int row = 0; row < measured.rows; ++row) {
    for (int column = 0; column < measured.columns; ++column) {
      const double gap_m =
          measured.at(row, column) - trace.h.at(rows.offset + row * rows.stride, column);
      terms.data_m2 += 0.5 * gap_m * gap_m;
    }
  }
  for (std::size_t i = 0; i < trace.h.range_m.size(); ++i) {
    const double z_gap_m = trace.z.range_m[i] - trace.h.range_m[i];
    const double y_gap_m = trace.y.range_m[i] - trace.h.range_m[i];
    terms.denoiser_gap_m2 += 0.5 * trace.penalty * z_gap_m * z_gap_m;
    if (!has_filter) continue;
    terms.filter_gap_m2 += 0.5 * trace.penalty * y_gap_m * y_gap_m;
    terms.rejected += trace.rejected[i];
  }
  return trace;
}

RangeImage UnrolledLifter::estimate(const RangeImage& measured) {
  network_.start(measured, state_);
  network_.forward(state_);
  return in_metres(network_.result(state_));
}

std::vector<NetworkStep> UnrolledLifter::steps(const RangeImage& measured) {
  lift(measured, 0.0F);
  return network_.steps(state_);
}

Trace UnrolledLifter::trace(const RangeImage& measured) {
  UnrolledState all = network_.make_state();
  network_.start(measured, all);
  network_.forward(all);
  if (network_.options().auxiliaries == Auxiliaries::kZAndY) network_.finish_last_layer(all);
  Trace trace{in_metres(all.z0), {}, {}};
  for (int layer = 0; layer < network_.options().layers; ++layer) {
    trace.layers.push_back(layer_trace(all, layer, measured));
  }
  return trace;
}

double UnrolledLifter::add_gradient(const RangeImage& measured, const RangeImage& truth,
                                    const LossOptions& options, std::uint64_t seed,
                                    std::span<float> d_parameters) {
  const NetworkDescription& d = network_.description();
  if (!training_) {
    UnrolledState state = network_.make_state();
    const Tensor image = state.z0;
    training_ = Training{std::move(state), image, {}};
    training_->d_z.assign(network_.options().layers, image);
  }
  const TileSize tile = network_.tile();
  RangeImage scaled = truth;
  for (float& range : scaled.range_m) range /= d.range_scale_m;
  to_tiles(scaled.range_m.data(), tile, training_->truth);
  network_.start(measured, training_->state);
  network_.forward(training_->state, seed);
  double loss = 0.0;
  for (int layer = 0; layer < network_.options().layers; ++layer) {
    const bool last = layer + 1 == network_.options().layers;
    loss = l1_loss(training_->state.layer(layer).denoiser.z, training_->truth, tile,
                   last ? std::optional(d.measured_rows) : std::nullopt,
                   last ? 1.0F : options.layer_share, training_->d_z[layer]);
  }
  network_.backward(training_->state, training_->d_z, d_parameters);
  return loss;
}

}  // namespace hqslam::nn

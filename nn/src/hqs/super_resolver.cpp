#include "hqslam/nn/hqs/super_resolver.h"

#include <fmt/format.h>
#include <omp.h>

#include <cmath>

#include "hqslam/core/error.h"
#include "hqslam/nn/hqs/result.h"
#include "hqslam/nn/hqs/unrolled_network.h"

namespace hqslam::nn {
namespace {

NetworkDescription with_options(NetworkDescription description,
                                const SuperResolverOptions& options) {
  if (options.filter) description.filter = description.last_filter = *options.filter;
  return description;
}

int threads_of(const SuperResolverOptions& options) {
  return options.threads > 0 ? options.threads : omp_get_max_threads();
}

}  // namespace

struct SuperResolver::Implementation {
  Implementation(const Weights& weights, const SuperResolverOptions& options_)
      : options(options_),
        threads(threads_of(options_)),
        network(with_options(weights.description, options_), weights.description.sensor.columns,
                options_.instruction_set.value_or(chosen_instruction_set()), threads),
        state(network.make_state(UnrolledNetwork::Kept::kLastTwo)),
        filter(network.description().sensor, network.description().measured_rows,
               network.description().last_filter, network.columns()),
        rejected(static_cast<std::size_t>(network.rows()) * network.columns()),
        parameters(static_cast<std::int64_t>(weights.parameters.size())) {
    network.set_parameters(weights.parameters);  // checks how many there are
    penalty = penalties(weights);
  }

  static std::vector<float> penalties(const Weights& weights);
  RangeImage measured_rows(const RangeImage& image) const;
  RangeImage in_metres(const Tensor& tiles) const;
  LayerTrace layer_trace(const UnrolledState& all, int layer, const RangeImage& measured) const;

  SuperResolverOptions options;
  int threads;
  UnrolledNetwork network;
  UnrolledState state;
  OutlierRemoval filter;
  std::vector<std::uint8_t> rejected;
  std::int64_t parameters;
  std::vector<float> penalty;
};

std::vector<float> SuperResolver::Implementation::penalties(const Weights& weights) {
  const NetworkDescription& d = weights.description;
  std::vector<float> penalty;
  for (int layer = 0; layer < d.layers; ++layer) {
    penalty.push_back(
        d.kind == NetworkKind::kSimpleDu
            ? 0.5F / weights.parameters.back()
            : std::exp(weights.parameters[weights.parameters.size() - d.layers + layer]));
  }
  return penalty;
}

RangeImage SuperResolver::Implementation::measured_rows(const RangeImage& image) const {
  const NetworkDescription& d = network.description();
  const int all = d.sensor.rows();
  const int stride = d.measured_rows.stride;
  const int measured = (all - d.measured_rows.offset + stride - 1) / stride;
  if (image.columns != d.sensor.columns || (image.rows != all && image.rows != measured)) {
    throw Error(fmt::format("upsampling: an image of {} x {}, expected {} or {} x {} ({})",
                            image.rows, image.columns, measured, all, d.sensor.columns,
                            d.sensor.name));
  }
  return image.rows == measured ? image : select_rows(image, d.measured_rows);
}

RangeImage SuperResolver::Implementation::in_metres(const Tensor& tiles) const {
  RangeImage image(network.rows(), network.columns());
  from_tiles(tiles, tile_of(network.description()), image.range_m.data());
  for (float& range_m : image.range_m) range_m *= network.description().range_scale_m;
  return image;
}

LayerTrace SuperResolver::Implementation::layer_trace(const UnrolledState& all, int layer,
                                                      const RangeImage& measured) const {
  const LayerState& from = all.layer(layer);
  const bool has_filter = network.description().kind == NetworkKind::kDuOr;
  LayerTrace trace{in_metres(from.denoiser.input),
                   in_metres(from.denoiser.z),
                   in_metres(has_filter ? from.y : from.denoiser.z),
                   from.rejected,
                   penalty[layer],
                   {}};
  const RowSelection rows = network.description().measured_rows;
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
    if (has_filter) terms.filter_gap_m2 += 0.5 * trace.penalty * y_gap_m * y_gap_m;
    terms.rejected += trace.rejected[i];
  }
  return trace;
}

SuperResolver SuperResolver::load(const std::string& path, const SuperResolverOptions& options) {
  const Weights weights = read_weights(path);
  check_self_test(weights, path);
  return {weights, options};
}

SuperResolver::SuperResolver(const Weights& weights, const SuperResolverOptions& options)
    : implementation_(std::make_unique<Implementation>(weights, options)) {}
SuperResolver::~SuperResolver() = default;
SuperResolver::SuperResolver(SuperResolver&&) noexcept = default;
SuperResolver& SuperResolver::operator=(SuperResolver&&) noexcept = default;

const NetworkDescription& SuperResolver::description() const {
  return implementation_->network.description();
}
std::int64_t SuperResolver::parameters() const { return implementation_->parameters; }
std::int64_t SuperResolver::multiply_adds() const {
  return implementation_->network.multiply_adds();
}

RangeImage SuperResolver::run(const RangeImage& image, Trace* trace) {
  Implementation& self = *implementation_;
  const RangeImage measured = self.measured_rows(image);
  std::optional<UnrolledState> all;
  if (trace != nullptr) all = self.network.make_state();
  UnrolledState& state = all ? *all : self.state;
  self.network.start(measured, state);
  self.network.forward(state);
  RangeImage result = restored_image(description(), tile_of(description()),
                                     self.network.result(state), measured, self.threads);
  if (self.options.filter_result) {
    self.filter.find(result.range_m.data(), self.rejected.data(), self.threads);
    for (std::size_t i = 0; i < result.range_m.size(); ++i) {
      result.range_m[i] = self.rejected[i] != 0 ? 0.0F : result.range_m[i];
    }
  }
  if (trace != nullptr) {
    if (description().kind == NetworkKind::kDuOr) self.network.finish_last_layer(state);
    *trace = Trace{self.in_metres(state.z0), {}, self.rejected};
    for (int layer = 0; layer < description().layers; ++layer) {
      trace->layers.push_back(self.layer_trace(state, layer, measured));
    }
  }
  return result;
}

}  // namespace hqslam::nn

#include "hqs_network.h"

#include <fmt/format.h>

#include <algorithm>

namespace hqslam::nn {

HqsNetwork::HqsNetwork(const NetworkDescription& description, int columns,
                       InstructionSet instruction_set, int threads)
    : description_(description),
      hqs_(description, columns, {instruction_set, threads}),
      threads_(threads),
      state_(hqs_.make_state(false)) {
  upsampled_.image = RangeImage(description.sensor.rows(), columns);
  if (hqs_.preset.says_confidence) upsampled_.confidence.resize(upsampled_.image.range_m.size());
}

std::int64_t HqsNetwork::multiply_adds() const {
  return hqs_.prior(0).multiply_adds() * hqs_.layers;
}

const UpsampledImage& HqsNetwork::upsample(const Observation& seen, float tolerance_m) {
  const PriorPass pass{.tolerance_m = tolerance_m, .upsampled = &upsampled_};
#pragma omp parallel num_threads(threads_)
  {
    hqs_loop(hqs_, seen, state_, pass);
    if (!hqs_.preset.says_confidence) {
      restore_rows(description_, hqs_.prior(0).tile(), last_z(), seen.measured, upsampled_.image);
    }
  }
  return upsampled_;
}

RangeImage HqsNetwork::estimate(const RangeImage& measured) {
  upsample(measured, 0.5F);
  return hqs_.preset.says_confidence ? upsampled_.image : hqs_.measurement.in_metres(last_z());
}

Trace HqsNetwork::trace(const Observation& seen) {
  HqsState all = hqs_.make_state(true);
  all.last_y = true;
#pragma omp parallel num_threads(threads_)
  hqs_loop(hqs_, seen, all, {});
  Trace trace;
  const auto image = [&](const std::string& name, const Tensor& tiles) {
    trace.add(traced_image(name, hqs_.measurement.in_metres(tiles)));
  };
  trace.add(traced_image("measured", seen.measured));
  if (seen.recalled != nullptr && !seen.recalled->is_empty()) {
    RangeImage weight = seen.recalled->image;
    weight.range_m = seen.recalled->weight;
    trace.add(traced_image("recalled", seen.recalled->image));
    trace.add(traced_image("recalled_weight", weight, ""));
  }
  image("start", hqs_.z0);
  for (int k = 0; k < hqs_.layers; ++k) {
    const HqsLayer& layer = all.layer(k);
    const std::string prefix = fmt::format("layers.{}.", k);
    if (hqs_.preset.learned_penalty) {
      RangeImage penalty(1, 1);
      penalty.at(0, 0) = hqs_.penalty[k];
      trace.add(traced_image(prefix + "penalty", penalty, ""));
    }
    image(prefix + "h", layer.prior.h());
    hqs_.prior(k).add_inner(hqs_.measurement, layer.prior, prefix, trace);
    image(prefix + "z", layer.prior.z);
    if (!hqs_.has_y()) continue;
    RangeImage rejected(upsampled_.image.rows, upsampled_.image.columns);
    rejected.range_m.assign(layer.rejected.begin(), layer.rejected.end());
    trace.add(traced_image(prefix + "rejected", rejected, ""));
    image(prefix + "y", layer.y);
  }
  return trace;
}

void restore_rows(const NetworkDescription& description, TileSize tile, const Tensor& z,
                  const RangeImage& measured, RangeImage& image) {
  const RowSelection rows = description.measured_rows;
  const auto nearest_m = static_cast<float>(description.sensor.min_range_m);
  const auto farthest_m = static_cast<float>(description.sensor.max_range_m);
#pragma omp for schedule(static)
  for (int row = 0; row < image.rows; ++row) {
    float* to = &image.range_m[image.index(row, 0)];
    if (rows.contains(row)) {
      const int from = (row - rows.offset) / rows.stride;
      std::copy_n(&measured.range_m[measured.index(from, 0)], measured.columns, to);
      continue;
    }
    take_image_row(z, tile, row, to);
#pragma omp simd
    for (int column = 0; column < image.columns; ++column) {
      const float range_m = to[column] * description.range_scale_m;
      const float not_too_far_m = range_m <= farthest_m ? range_m : 0.0F;
      to[column] = not_too_far_m >= nearest_m ? not_too_far_m : 0.0F;
    }
  }
}

}  // namespace hqslam::nn

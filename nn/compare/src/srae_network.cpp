#include "srae_network.h"

#include <algorithm>
#include <cmath>

#include "hqslam/nn/trace.h"

namespace hqslam::nn {
namespace {

/// The seeds of each pass for its layers.
constexpr std::uint64_t kSeedsOfPass = 64;

}  // namespace

SraeNetwork::SraeNetwork(const Srae& architecture, const NetworkDescription& description,
                         int columns, const Engine& engine)
    : description_(description),
      shape_(architecture.shape()),
      graph_(architecture.graph(description, columns, engine)),
      values_(graph_.make_values()) {
  const TensorShape& output = graph_.output_shape();
  sum_.resize(static_cast<std::size_t>(output.values()));
  squares_.resize(sum_.size());
  upsampled_.image = RangeImage(output.rows, output.columns);
}

std::int64_t SraeNetwork::multiply_adds() const {
  return graph_.multiply_adds() +
         (shape_.passes - 1) * graph_.multiply_adds(graph_.first_random_layer());
}

float scaled_range(float range_m, float range_scale_m) {
  return range_m > 0.0F && std::isfinite(range_m) ? range_m / range_scale_m : 0.0F;
}

void take_scaled(const RangeImage& image, float range_scale_m, Tensor& tensor) {
#pragma omp for schedule(static)
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.columns; ++x) {
      tensor.at(0, y, x) = scaled_range(image.at(y, x), range_scale_m);
    }
    tensor.fill_border(0, y);
  }
}

void SraeNetwork::add_pass(bool first) {
  const Tensor& output = values_.back();
#pragma omp for schedule(static)
  for (int y = 0; y < output.rows(); ++y) {
    for (int x = 0; x < output.columns(); ++x) {
      const std::size_t pixel = upsampled_.image.index(y, x);
      const double value = output.at(0, y, x);
      sum_[pixel] = (first ? 0.0 : sum_[pixel]) + value;
      squares_[pixel] = (first ? 0.0 : squares_[pixel]) + value * value;
    }
  }
}

/// What stands before the first dropout is the same in every pass.
void SraeNetwork::run_passes(const RangeImage& measured, int passes) {
  const int random = graph_.first_random_layer();
#pragma omp parallel num_threads(graph_.engine().threads)
  {
    take_scaled(measured, description_.range_scale_m, values_.front());
    for (int pass = 0; pass < passes; ++pass) {
      std::optional<std::uint64_t> seed;
      if (passes > 1) seed = static_cast<std::uint64_t>(pass) * kSeedsOfPass;
      graph_.forward(values_, {.seed = seed, .first = pass == 0 ? 0 : random});
      add_pass(pass == 0);
    }
  }
}

float SraeNetwork::mean(std::size_t pixel) const {
  return static_cast<float>(sum_[pixel] / shape_.passes);
}

bool SraeNetwork::agreed(std::size_t pixel) const {
  if (shape_.passes == 1) return true;
  const double mean = sum_[pixel] / shape_.passes;
  const double variance = std::max(0.0, squares_[pixel] / shape_.passes - mean * mean);
  return std::sqrt(variance) <= static_cast<double>(shape_.largest_deviation) * mean;
}

void SraeNetwork::restore(const RangeImage& measured, RangeImage& image) const {
  const RowSelection rows = description_.measured_rows;
  for (int row = 0; row < measured.rows; ++row) {
    std::copy_n(&measured.range_m[measured.index(row, 0)], measured.columns,
                &image.range_m[image.index(rows.offset + row * rows.stride, 0)]);
  }
}

const UpsampledImage& SraeNetwork::upsample(const Observation& seen, float /*tolerance_m*/) {
  const RangeImage& measured = seen.measured;
  run_passes(measured, shape_.passes);
  const auto nearest_m = static_cast<float>(description_.sensor.min_range_m);
  const auto farthest_m = static_cast<float>(description_.sensor.max_range_m);
#pragma omp parallel for schedule(static) num_threads(graph_.engine().threads)
  for (std::size_t pixel = 0; pixel < sum_.size(); ++pixel) {
    const float range_m = mean(pixel) * description_.range_scale_m;
    const bool there = range_m >= nearest_m && range_m <= farthest_m && agreed(pixel);
    upsampled_.image.range_m[pixel] = there ? range_m : 0.0F;
  }
  restore(measured, upsampled_.image);
  return upsampled_;
}

/// One pass without dropout.
RangeImage SraeNetwork::estimate(const RangeImage& measured) {
  run_passes(measured, 1);
  RangeImage image(upsampled_.image.rows, upsampled_.image.columns);
  for (std::size_t i = 0; i < sum_.size(); ++i) {
    image.range_m[i] = static_cast<float>(sum_[i]) * description_.range_scale_m;
  }
  return image;
}

Trace SraeNetwork::trace(const Observation& seen) {
  const RangeImage upsampled = upsample(seen, 0.5F).image;
  RangeImage estimated = upsampled;
  RangeImage disagreed = upsampled;
  for (std::size_t pixel = 0; pixel < sum_.size(); ++pixel) {
    estimated.range_m[pixel] = mean(pixel) * description_.range_scale_m;
    disagreed.range_m[pixel] = agreed(pixel) ? 0.0F : 1.0F;
  }
  Trace trace;
  trace.add(traced_image("measured", seen.measured));
  trace.add(traced_image("layers.0.z", estimated));
  trace.add(traced_image("layers.0.rejected", disagreed, ""));
  trace.add(traced_image("layers.0.y", upsampled));
  return trace;
}

}  // namespace hqslam::nn

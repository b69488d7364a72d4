#include "hqslam/nn/upsampler.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <utility>

#include "hqslam/core/error.h"

namespace hqslam::nn {
namespace {

/// In the order of Interpolation.
constexpr std::array<std::string_view, 3> kNames = {"nearest", "linear", "inverse"};

}  // namespace

std::vector<std::string> interpolation_names() { return {kNames.begin(), kNames.end()}; }

bool is_interpolation(std::string_view name) {
  return std::ranges::find(kNames, name) != kNames.end();
}

Interpolation interpolation_from_name(std::string_view name) {
  const auto found = std::ranges::find(kNames, name);
  if (found != kNames.end()) return static_cast<Interpolation>(found - kNames.begin());
  throw Error("expected an interpolation, found '{}'; choose one of {}", name,
              fmt::join(kNames, ", "));
}

Upsampler::Upsampler(SuperResolver network) : method_(std::move(network)) {
  sensor_ = this->network()->sensor();
  sensor_.measured_rows = this->network()->description().measured_rows;
}

Upsampler::Upsampler(SuperResolver network, SensorModel sensor)
    : method_(std::move(network)), sensor_(std::move(sensor)) {
  sensor_.measured_rows = this->network()->description().measured_rows;
}

Upsampler::Upsampler(Interpolation interpolation, SensorModel sensor, RowSelection measured_rows)
    : method_(interpolation), sensor_(std::move(sensor)) {
  sensor_.measured_rows = measured_rows;
}

std::string Upsampler::name() const {
  if (network() != nullptr) return std::string(nn::name(network()->description()));
  return std::string(kNames[static_cast<std::size_t>(std::get<Interpolation>(method_))]);
}

UpsampledImage Upsampler::run(const RangeImage& measured, const RecalledImage& recalled) {
  if (auto* resolver = std::get_if<SuperResolver>(&method_)) {
    return resolver->run(measured, recalled);
  }
  return {interpolate_rows(measured, measured_rows(), sensor_.beam_elevation_rad,
                           std::get<Interpolation>(method_)),
          {}};
}

}  // namespace hqslam::nn

#include "hqslam/nn/upsampler.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <utility>

#include "hqslam/core/error.h"

namespace hqslam::nn {
namespace {

struct NamedInterpolation {
  const char* name;
  Interpolation interpolation;
};
constexpr std::array<NamedInterpolation, 3> kInterpolations = {{
    {"nearest", Interpolation::kNearest},
    {"linear", Interpolation::kLinear},
    {"inverse", Interpolation::kInverse},
}};

}  // namespace

std::vector<std::string> interpolation_names() {
  std::vector<std::string> names;
  for (const NamedInterpolation& named : kInterpolations) {
    names.emplace_back(named.name);
  }
  return names;
}

bool is_interpolation(std::string_view name) {
  for (const NamedInterpolation& named : kInterpolations) {
    if (named.name == name) {
      return true;
    }
  }
  return false;
}

Interpolation interpolation_from_name(std::string_view name) {
  for (const NamedInterpolation& named : kInterpolations) {
    if (named.name == name) {
      return named.interpolation;
    }
  }
  throw Error(fmt::format("'{}' is no interpolation; choose one of {}", name,
                          fmt::join(interpolation_names(), ", ")));
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
  if (network() != nullptr) {
    return std::string(nn::name(network()->description()));
  }
  for (const NamedInterpolation& named : kInterpolations) {
    if (named.interpolation == std::get<Interpolation>(method_)) {
      return named.name;
    }
  }
  return "";
}

LiftedImage Upsampler::run(const RangeImage& measured) {
  if (auto* resolver = std::get_if<SuperResolver>(&method_)) {
    return resolver->run(measured);
  }
  return {interpolate_rows(measured, measured_rows(), sensor_.beam_elevation_rad,
                           std::get<Interpolation>(method_)),
          {}};
}

}  // namespace hqslam::nn

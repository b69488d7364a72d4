#include "hqslam/nn/super_resolver.h"

#include <omp.h>

#include "architecture.h"
#include "hqslam/core/error.h"
#include "hqslam/nn/hqs/outlier_removal.h"
#include "hqslam/nn/interpolation.h"
#include "hqslam/nn/network.h"
#include "hqslam/nn/trace.h"
#include "parameters.h"

namespace hqslam::nn {
namespace {

NetworkDescription with_options(NetworkDescription description,
                                const SuperResolverOptions& options) {
  if (options.least_confidence) description.least_confidence = *options.least_confidence;
  check_least_confidence(description);
  return description;
}

std::optional<OutlierRemoval> filter_of(const NetworkDescription& d) {
  const std::optional<OutlierRemovalOptions> options = last_filter(d);
  if (!options) return std::nullopt;
  return OutlierRemoval(d.sensor, d.measured_rows, *options, d.sensor.columns);
}

int threads_of(const SuperResolverOptions& options) {
  return options.threads > 0 ? options.threads : omp_get_max_threads();
}

float checked_tolerance_m(float tolerance_m) {
  check_that(tolerance_m > 0.0F && tolerance_m < 1e3F, "upsampling", "tolerance_m", tolerance_m,
             "above 0 and below 1000");
  return tolerance_m;
}

}  // namespace

struct SuperResolver::Implementation {
  Implementation(const Weights& weights, const SuperResolverOptions& options)
      : description(with_options(weights.description, options)),
        threads(threads_of(options)),
        tolerance_m(checked_tolerance_m(options.tolerance_m)),
        network(make_network(description, description.sensor.columns,
                             options.instruction_set.value_or(chosen_instruction_set()), threads)),
        filter(options.filter_result ? filter_of(description) : std::nullopt),
        rejected(static_cast<std::size_t>(description.sensor.rows()) * description.sensor.columns),
        made_with(options),
        parameters(weights.parameters) {
    network->set_parameters(parameters);
  }

  RangeImage measured_rows(const RangeImage& image) const;
  void check(const RecalledImage& recalled) const;
  void empty_doubtful(UpsampledImage& upsampled) const;
  void empty_rejected(UpsampledImage& upsampled);
  void trace(const Observation& seen, const std::vector<float>& confidence,
             const UpsampledImage& upsampled, Trace& trace);

  NetworkDescription description;
  int threads;
  float tolerance_m;
  std::unique_ptr<Network> network;
  std::optional<OutlierRemoval> filter;  ///< at the end
  std::vector<std::uint8_t> rejected;    ///< by the filter at the end
  SuperResolverOptions made_with;
  std::vector<float> parameters;
};

RangeImage SuperResolver::Implementation::measured_rows(const RangeImage& image) const {
  const int all = description.sensor.rows();
  const RowSelection rows = description.measured_rows;
  const int measured = measured_row_count(all, rows);
  const bool fits =
      image.columns == description.sensor.columns && (image.rows == all || image.rows == measured);
  if (!fits || image.range_m.size() != static_cast<std::size_t>(image.rows) * image.columns) {
    throw Error("upsampling: an image of {} x {} with {} ranges, expected {} or {} x {} ({})",
                image.rows, image.columns, image.range_m.size(), measured, all,
                description.sensor.columns, description.sensor.name);
  }
  RangeImage result = image.rows == measured ? image : select_rows(image, rows);
  const auto farthest_m = static_cast<float>(description.sensor.max_range_m);
  for (float& range_m : result.range_m) {
    if (!(range_m > 0.0F && range_m <= farthest_m)) range_m = 0.0F;
  }
  return result;
}

void SuperResolver::Implementation::check(const RecalledImage& recalled) const {
  const RangeImage& image = recalled.image;
  if (recalled.is_empty() ||
      (image.rows == description.sensor.rows() && image.columns == description.sensor.columns &&
       image.range_m.size() == rejected.size() && recalled.weight.size() == rejected.size())) {
    return;
  }
  throw Error(
      "upsampling: recalled ranges of {} x {} with {} weights, expected {} x {} with a weight for "
      "each pixel; recall them for {}",
      image.rows, image.columns, recalled.weight.size(), description.sensor.rows(),
      description.sensor.columns, description.sensor.name);
}

void SuperResolver::Implementation::empty_doubtful(UpsampledImage& upsampled) const {
  for (std::size_t i = 0; i < upsampled.confidence.size(); ++i) {
    if (upsampled.confidence[i] < description.least_confidence) {
      upsampled.image.range_m[i] = upsampled.confidence[i] = 0.0F;
    }
  }
}

void SuperResolver::Implementation::empty_rejected(UpsampledImage& upsampled) {
  if (!filter) return;
  filter->find(upsampled.image.range_m.data(), rejected.data(), threads);
  for (std::vector<float>* values : {&upsampled.image.range_m, &upsampled.confidence}) {
    float* value = values->data();
#pragma omp simd
    for (std::size_t i = 0; i < values->size(); ++i) value[i] = rejected[i] == 0 ? value[i] : 0.0F;
  }
}

/// confidence: of the network, also in pixels that are emptied afterwards.
void SuperResolver::Implementation::trace(const Observation& seen,
                                          const std::vector<float>& confidence,
                                          const UpsampledImage& upsampled, Trace& trace) {
  trace = network->trace(seen);
  RangeImage image = upsampled.image;
  if (filter) {
    image.range_m.assign(rejected.begin(), rejected.end());
    trace.add(traced_image("rejected", image, ""));
  }
  if (!confidence.empty()) {
    image.range_m = confidence;
    trace.add(traced_image("confidence", image, ""));
  }
  trace.add(traced_image("result", upsampled.image));
}

SuperResolver SuperResolver::load(const std::string& path, const SuperResolverOptions& options) {
  return checked(read_weights(path, options.architectures), path, options);
}

SuperResolver SuperResolver::checked(const Weights& weights, const std::string& path,
                                     const SuperResolverOptions& options) {
  SuperResolver resolver(weights, options);
  check_self_test(*resolver.implementation_->network, weights.description, weights.self_test, path);
  return resolver;
}

SuperResolver::SuperResolver(const Weights& weights, const SuperResolverOptions& options)
    : implementation_(std::make_unique<Implementation>(weights, options)) {}
SuperResolver::~SuperResolver() = default;

SuperResolver SuperResolver::for_sensor(const SensorModel& sensor,
                                        RowSelection measured_rows) const {
  const Implementation& self = *implementation_;
  return {Weights{nn::for_sensor(self.description, sensor, measured_rows), self.parameters, "", {}},
          self.made_with};
}

SuperResolver::SuperResolver(SuperResolver&&) noexcept = default;
SuperResolver& SuperResolver::operator=(SuperResolver&&) noexcept = default;

const NetworkDescription& SuperResolver::description() const {
  return implementation_->description;
}
std::int64_t SuperResolver::parameters() const {
  return static_cast<std::int64_t>(implementation_->parameters.size());
}
std::int64_t SuperResolver::multiply_adds() const {
  return implementation_->network->multiply_adds();
}

UpsampledImage SuperResolver::run(const RangeImage& image, const RecalledImage& recalled,
                                  Trace* trace) {
  Implementation& self = *implementation_;
  const RangeImage measured = self.measured_rows(image);
  self.check(recalled);
  UpsampledImage upsampled = self.network->upsample({measured, recalled}, self.tolerance_m);
  std::vector<float> confidence;
  if (trace != nullptr) confidence = upsampled.confidence;
  self.empty_doubtful(upsampled);
  self.empty_rejected(upsampled);
  if (trace != nullptr) self.trace({measured, recalled}, confidence, upsampled, *trace);
  return upsampled;
}

}  // namespace hqslam::nn

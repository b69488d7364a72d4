#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <filesystem>

#include "hqslam/core/error.h"
#include "hqslam/nn/super_resolver.h"
#include "hqslam/nn/trace.h"
#include "hqslam/pipeline/upsampler.h"
#include "parts.h"
#include "paths.h"
#include "scans.h"
#include "traces.h"

namespace hqslam::python {
namespace {

using Resolver = Guarded<nn::SuperResolver>;
using Upsampling = Guarded<pipeline::Upsampler>;

nn::SuperResolver loaded(const std::filesystem::path& weights, int threads,
                         std::optional<float> least_confidence) {
  return nn::SuperResolver::load(weights.string(),
                                 {.threads = threads, .least_confidence = least_confidence});
}

void show_tensors(nn::Trace trace, nb::dict arrays) {
  TraceArrays<nn::Trace> shown(std::move(trace), std::move(arrays));
  for (const nn::TracedTensor& tensor : shown.trace().tensors()) {
    shown.show(
        tensor.name, tensor.values.data(),
        {static_cast<std::size_t>(tensor.channels()), static_cast<std::size_t>(tensor.rows()),
         static_cast<std::size_t>(tensor.columns())});
  }
}

const nn::RecalledImage& or_nothing(const nn::RecalledImage* recalled) {
  static const nn::RecalledImage nothing;
  return recalled != nullptr ? *recalled : nothing;
}

nn::UpsampledImage run(Resolver& resolver, const ImageInput& range_m, const TraceInput& trace,
                       const nn::RecalledImage* recalled) {
  const RangeImage image = image_of(range_m);
  nn::Trace written;
  nn::UpsampledImage upsampled = resolver.call([&](nn::SuperResolver& network) {
    return network.run(image, or_nothing(recalled), trace ? &written : nullptr);
  });
  if (trace) show_tensors(std::move(written), *trace);
  return upsampled;
}

void make_upsampler(Upsampling* self, const std::filesystem::path& method,
                    const std::optional<SensorModel>& sensor, int measured_rows, double spacing_rad,
                    int threads, std::optional<float> least_confidence) {
  if (method.empty()) throw Error("Upsampler: expected weights or an interpolation, found ''");
  const OthersGoOn others_go_on;
  pipeline::UpsamplingOptions options{method.string(), measured_rows, spacing_rad};
  options.network.threads = threads;
  options.network.least_confidence = least_confidence;
  new (self)
      Upsampling(sensor ? pipeline::Upsampler(*sensor, options) : pipeline::Upsampler(options));
}

void add_super_resolver(nb::module_& module) {
  using namespace nb::literals;
  nb::class_<nn::UpsampledImage>(module, "UpsampledImage", "A scan with all rows.")
      .def_prop_ro(
          "range_m",
          [](nn::UpsampledImage& l) {
            return view(l.image.range_m, l.image.rows, l.image.columns);
          },
          "(rows, columns) float32, metres; 0 is no return; measured rows as they were.")
      .def_prop_ro(
          "confidence",
          [](nn::UpsampledImage& l) -> std::optional<Image> {
            if (l.confidence.empty()) return std::nullopt;
            return view(l.confidence, l.image.rows, l.image.columns);
          },
          "(rows, columns) float32: the probability that there is a return within 0.5 m of "
          "range_m; "
          "None: the method gives none.");

  nb::class_<Resolver>(module, "SuperResolver", "A network that upsamples range images.")
      .def(
          "__init__",
          [](Resolver* self, const std::filesystem::path& weights, int threads,
             std::optional<float> least_confidence) {
            const OthersGoOn others_go_on;
            new (self) Resolver(loaded(weights, threads, least_confidence));
          },
          "weights"_a, nb::kw_only(), "threads"_a = 0, "least_confidence"_a = nb::none(),
          "weights: an .npz file. threads: 0, all. least_confidence: computed pixels with less "
          "come "
          "out empty, 0 to 1; none: the file's. Raises Error.")
      .def(
          "run", &run, "range_m"_a, "trace"_a = nb::none(), "recalled"_a = nb::none(),
          "Upsamples a scan. range_m: (measured rows or rows, columns), metres; what is not above "
          "0 is "
          "no return. trace: a dict that is filled with every inner tensor by its name, (channels, "
          "rows, columns) float32. recalled: as Upsampler.run. Raises Error.")
      .def_prop_ro("sensor", &ask<&nn::SuperResolver::sensor, nn::SuperResolver>,
                   "Of the result, all rows.")
      .def_prop_ro("parameters", &ask<&nn::SuperResolver::parameters, nn::SuperResolver>,
                   "Numbers that were learned.");
}

}  // namespace

void add_upsampling(nb::module_& module) {
  using namespace nb::literals;
  add_super_resolver(module);
  const auto upsample_points = [](Upsampling& upsampler, const PointsInput& points_m,
                                  const RowsInput& row, const TimesInput& time_offset_s) {
    return upsampler.call([&](pipeline::Upsampler& u) {
      return u.upsampled(cloud_of(points_m, u.measured_sensor(), row, time_offset_s));
    });
  };
  nb::class_<Upsampling>(module, "Upsampler",
                         "Fills the rows between the measured ones: a network or interpolation.")
      .def("__init__", &make_upsampler, "method"_a, "sensor"_a = nb::none(), nb::kw_only(),
           "measured_rows"_a = 0, "spacing_rad"_a = 0.0, "threads"_a = 0,
           "least_confidence"_a = nb::none(),
           "method: a weights file, the name of weights that come with hqslam (du-mix), or "
           "nearest, linear or inverse. sensor: of the recorded scans, with all rows or the "
           "measured ones alone; none: that of the weights. measured_rows: how many of its rows "
           "are measured; 0: as the weights have it, or every fourth. spacing_rad: widest gap "
           "between two rows of the result, with weights for any sensor; 0: 64 rows. threads, "
           "least_confidence: as SuperResolver. Raises Error.")
      .def(
          "run",
          [](Upsampling& upsampler, const ImageInput& range_m, const nn::RecalledImage* recalled) {
            const RangeImage measured = image_of(range_m);
            return upsampler.call([&](pipeline::Upsampler& u) {
              return u.method()->run(measured, or_nothing(recalled));
            });
          },
          "range_m"_a, "recalled"_a = nb::none(),
          "Upsamples a range image: (measured rows, columns), metres; 0 is no return. recalled: "
          "what ScanMemory.recall gave, for weights with a memory. Raises Error.")
      .def(
          "measured",
          [](Upsampling& upsampler, const OrganizedCloud& recorded) {
            return upsampler.call([&](pipeline::Upsampler& u) { return u.measured(recorded); });
          },
          "recorded"_a, "The measured rows of a recorded scan, calibrated. Raises Error.")
      .def(
          "upsampled_cloud",
          [](Upsampling& upsampler, const OrganizedCloud& measured,
             const nn::RecalledImage* recalled) {
            return upsampler.call([&](pipeline::Upsampler& u) {
              return u.upsampled(measured, or_nothing(recalled));
            });
          },
          "measured"_a, "recalled"_a = nb::none(),
          "Upsamples a scan: measured points and times stay as recorded, computed ones come "
          "between them, with their confidence. recalled: as run. Raises Error.")
      .def("upsampled_cloud", upsample_points, "points_m"_a, "row"_a = nb::none(),
           "time_offset_s"_a = nb::none(), "Upsamples points as project takes them.")
      .def_prop_ro("sensor", &ask<&pipeline::Upsampler::sensor, pipeline::Upsampler>,
                   "Of the result, all rows.")
      .def_prop_ro("measured_sensor",
                   &ask<&pipeline::Upsampler::measured_sensor, pipeline::Upsampler>,
                   "Of what is upsampled.")
      .def_prop_ro(
          "name",
          [](Upsampling& upsampler) {
            return upsampler.call([](pipeline::Upsampler& u) { return u.method()->name(); });
          },
          "du-mix, linear, ...");
}

}  // namespace hqslam::python

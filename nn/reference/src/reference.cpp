#include "hqslam/nn/reference/reference.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hqslam/core/error.h"
#include "hqslam/nn/network_json.h"
#include "scan.h"

namespace hqslam::nn {
namespace {

void check(const NetworkDescription& d, const RangeImage& measured,
           const ReferenceOptions& options) {
  const int rows = select_rows(d.sensor, d.measured_rows).rows();
  if (measured.rows != rows || measured.columns < 1 || measured.columns > d.sensor.columns) {
    throw Error("reference: an image of {} x {}, expected {} rows and up to {} columns",
                measured.rows, measured.columns, rows, d.sensor.columns);
  }
  const std::size_t pixels = static_cast<std::size_t>(d.sensor.rows()) * measured.columns;
  const RecalledImage& recalled = options.recalled;
  if (!recalled.is_empty() &&
      (recalled.image.rows != d.sensor.rows() || recalled.image.columns != measured.columns ||
       recalled.weight.size() != pixels)) {
    throw Error("reference: {} x {} pixels are recalled with {} weights, expected {} x {}",
                recalled.image.rows, recalled.image.columns, recalled.weight.size(),
                d.sensor.rows(), measured.columns);
  }
  for (const std::vector<std::uint8_t>& mask : options.rejected) {
    if (mask.size() != pixels) {
      throw Error("reference: a mask of {} pixels, expected {}", mask.size(), pixels);
    }
  }
}

std::vector<std::vector<std::uint8_t>> masks_of(const Trace& trace) {
  std::vector<std::vector<std::uint8_t>> masks;
  for (int k = 0; trace.has(fmt::format("layers.{}.rejected", k)); ++k) {
    const std::span<const float> mask = trace.tensor(fmt::format("layers.{}.rejected", k)).all();
    masks.emplace_back(mask.begin(), mask.end());
  }
  return masks;
}

}  // namespace

const ReferenceTensor& ReferenceTrace::tensor(std::string_view name) const {
  const auto found = std::ranges::find(tensors, name, &ReferenceTensor::name);
  if (found == tensors.end()) throw Error("reference: no tensor '{}'", name);
  return *found;
}

ReferenceTrace reference_trace(const NetworkDescription& description,
                               std::span<const double> parameters, const RangeImage& measured,
                               const ReferenceOptions& options) {
  check(description, measured, options);
  reference::Run run{description,
                     nlohmann::json::parse(network_json(description)),
                     reference::Parameters(description, parameters),
                     measured,
                     options,
                     {}};
  const std::string_view kind = name(description);
  if (kind == "du-or" || kind == "simple-du") {
    run_hqs(run);
  } else if (kind == "du-mix") {
    run_du_mix(run);
  } else {
    throw Error("reference: there is none of '{}', expected du-or, simple-du or du-mix", kind);
  }
  return std::move(run.trace);
}

std::vector<ReferenceDifference> differences_from_reference(const NetworkDescription& description,
                                                            std::span<const float> parameters,
                                                            const Trace& trace) {
  const std::vector<double> exact(parameters.begin(), parameters.end());
  ReferenceOptions options{.rejected = masks_of(trace)};
  if (trace.has("recalled")) {
    options.recalled = {trace.image("recalled"), trace.image("recalled_weight").range_m};
  }
  const ReferenceTrace reference =
      reference_trace(description, exact, trace.image("measured"), options);
  std::vector<ReferenceDifference> differences;
  for (const ReferenceTensor& expected : reference.tensors) {
    if (!trace.has(expected.name) || expected.name.ends_with(".rejected")) continue;
    const std::span<const float> values = trace.tensor(expected.name).all();
    ReferenceDifference difference{expected.name, expected.unit};
    double squares = 0.0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double gap = std::fabs(values[i] - expected.all()[i]);
      difference.largest = std::max(difference.largest, gap);
      squares += gap * gap;
    }
    difference.root_mean_square = std::sqrt(squares / static_cast<double>(values.size()));
    differences.push_back(std::move(difference));
  }
  return differences;
}

}  // namespace hqslam::nn

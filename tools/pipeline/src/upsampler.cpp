#include "hqslam/pipeline/upsampler.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "hqslam/core/angles.h"
#include "hqslam/core/error.h"
#include "hqslam/core/projection.h"
#include "hqslam/nn/upsampled_cloud.h"

namespace hqslam::pipeline {
namespace {

/// An interpolation of all rows takes every fourth as measured, of sensors with at least 64 rows.
constexpr int kInterpolationFactor = 4;
constexpr int kFewestRowsToThin = 64;

/// In an image of more columns than a turn has, a network would take the gaps for no return.
void check_columns(const UpsamplingOptions& options, const std::string& source, int found,
                   int expected) {
  if (found >= kFewestColumnsShare * expected) return;
  throw Error(
      "{}: expects {} columns a turn, {} has {}; let the sensor turn more slowly, interpolate, or "
      "train for it (docs/training.md)",
      options.method, expected, source, found);
}

[[noreturn]] void fail_for_sensor(const SensorModel& found, const SensorModel& full,
                                  RowSelection measured_rows, const std::string& method,
                                  const std::string& source) {
  const SensorModel measured = select_rows(full, measured_rows);
  throw Error(
      "{}: expects scans of '{}' ({} x {}) or its rows {}, {}, ... alone ({} x {}), beams within "
      "{} degrees, but {} is of '{}' ({} x {}); give weights made for that sensor, or name the "
      "sensor if it is another one",
      method, full.name, full.rows(), full.columns, measured_rows.offset,
      measured_rows.offset + measured_rows.stride, measured.rows(), measured.columns,
      kBeamTolerance_deg, source, found.name, found.rows(), found.columns);
}

[[noreturn]] void fail_for_spacing(const std::string& method) {
  throw Error(
      "{}: a spacing needs weights for any sensor (du-mix) and all rows of the recording; leave "
      "out the spacing, or the number of rows",
      method);
}

/// Sensors with fewer rows get as many in all.
constexpr int kUsualRows = 64;

/// Most rows of the result for each of the recording. Weights for any sensor were tried with up to
/// seven rows between two beams (weights/RESULTS.md, "Any number of computed rows").
constexpr int kMostFactor = 8;

/// How many rows the result has for each of the recording. Throws Error.
int row_factor(const SensorModel& recorded, const UpsamplingOptions& options) {
  if (options.spacing_rad <= 0.0) return std::max(2, kUsualRows / recorded.rows());
  double widest_rad = 0.0;
  for (int row = 0; row + 1 < recorded.rows(); ++row) {
    widest_rad = std::max(widest_rad,
                          recorded.beam_elevation_rad[row] - recorded.beam_elevation_rad[row + 1]);
  }
  // An error of rounding is no reason for another row.
  const double factor = std::ceil(widest_rad / options.spacing_rad - 1e-6);
  if (factor >= 2.0 && factor <= kMostFactor) return static_cast<int>(factor);
  throw Error(
      "{}: expected a spacing of {:.2f} degrees or more, and less than the sensor's widest gap of "
      "{:.2f}, found {:.2f}",
      options.method, degrees(widest_rad) / kMostFactor, degrees(widest_rad),
      degrees(options.spacing_rad));
}

/// The network for any sensor, made for this one: with `rows` of its rows, or, with all of them,
/// for the rows between. Throws Error.
nn::SuperResolver fitted(const nn::SuperResolver& network, SensorModel recorded,
                         const UpsamplingOptions& options) {
  recorded.columns -= recorded.columns % column_multiple(network.description());
  if (options.rows > 0 && options.rows < recorded.rows()) {
    return network.for_sensor(recorded, selection_for(recorded.rows(), options.rows));
  }
  const int factor = row_factor(recorded, options);
  return network.for_sensor(with_rows_between(recorded, factor), {factor - 1, factor});
}

/// The sensor that the weights were made for, its measured rows alone.
SensorModel measured_sensor_of(const UpsamplingMethod& method, const UpsamplingOptions& options) {
  const std::optional<SensorModel> full = sensor_of(method);
  if (full) return select_rows(*full, *full->measured_rows);
  throw Error("'{}': expected weights, which name their sensor, found none; give the sensor",
              options.method);
}

}  // namespace

Upsampler::Upsampler(const SensorModel& recorded, const UpsamplingOptions& options,
                     const std::string& source)
    : Upsampler(recorded, load_method(options, recorded), options, source) {}

Upsampler::Upsampler(const UpsamplingOptions& options) {
  UpsamplingMethod method = load_method(options);
  const SensorModel measured = measured_sensor_of(method, options);
  *this = Upsampler(measured, std::move(method), options);
}

Upsampler::Upsampler(const SensorModel& recorded, UpsamplingMethod method,
                     const UpsamplingOptions& options, const std::string& source)
    : recorded_(recorded), columns_(recorded.columns) {
  if (auto* network = std::get_if<nn::SuperResolver>(&method)) {
    fit_network(std::move(*network), options, source);
  } else if (const auto* interpolation = std::get_if<nn::Interpolation>(&method)) {
    if (options.spacing_rad > 0.0) fail_for_spacing(options.method);
    fit_interpolation(*interpolation, options, source);
  } else if (options.rows > 0 && options.rows != recorded_.rows()) {
    rows_ = selection_for(recorded_.rows(), options.rows);
  }
  if (options.corrected) {
    recorded_.elevation_correction_rad = options.corrected->elevation_correction_rad;
    recorded_.range_correction_m = options.corrected->range_correction_m;
  }
  measured_sensor_ = rows_ ? select_rows(recorded_, *rows_) : recorded_;
}

void Upsampler::fit_network(nn::SuperResolver network, const UpsamplingOptions& options,
                            const std::string& source) {
  const bool fits_any = fits_any_sensor(network.description());
  const bool has_all_rows = options.rows == 0 || options.rows == recorded_.rows();
  if (options.spacing_rad > 0.0 && !(fits_any && has_all_rows)) fail_for_spacing(options.method);
  if (fits_any) network = fitted(network, recorded_, options);
  SensorModel full = network.sensor();
  const RowSelection measured_rows = network.description().measured_rows;
  const SensorModel measured = select_rows(full, measured_rows);
  if (options.rows > 0 && options.rows != measured.rows()) {
    throw Error("{}: expected its {} measured rows, found --rows {}; leave --rows out",
                options.method, measured.rows(), options.rows);
  }
  check_columns(options, source, recorded_.columns, full.columns);
  recorded_.columns = full.columns;
  if (have_same_beams(recorded_, full)) {
    rows_ = measured_rows;
    method_.emplace(std::move(network), recorded_);
  } else if (have_same_beams(recorded_, measured)) {
    full.scan_period_s = recorded_.scan_period_s;
    full.min_range_m = recorded_.min_range_m;
    full.max_range_m = recorded_.max_range_m;
    method_.emplace(std::move(network), full);
  } else {
    recorded_.columns = columns_;
    fail_for_sensor(recorded_, full, measured_rows, options.method, source);
  }
}

void Upsampler::fit_interpolation(nn::Interpolation interpolation, const UpsamplingOptions& options,
                                  const std::string& source) {
  SensorModel full = options.all_rows.value_or(recorded_);
  full.columns = recorded_.columns;
  const int rows = recorded_.rows();
  if (rows < full.rows()) {
    if (options.rows > 0 && options.rows != rows) {
      throw Error("{}: has {} rows, expected {} to be used as measured; leave their number out",
                  source, rows, options.rows);
    }
    const RowSelection measured_rows = selection_for(full.rows(), rows);
    recorded_ = select_rows(full, measured_rows);
    method_.emplace(interpolation, full, measured_rows);
    return;
  }
  if (options.rows == 0 && rows < kFewestRowsToThin) {
    throw Error(
        "{}: has all {} rows of sensor '{}', so there is nothing between them to fill; name the "
        "sensor with the rows to fill (os1-64 for scans of an os1-16), or choose with "
        "--rows how many of the {} are used as measured",
        source, rows, full.name, rows);
  }
  rows_ = selection_for(rows, options.rows > 0 ? options.rows : rows / kInterpolationFactor);
  method_.emplace(interpolation, full, *rows_);
}

OrganizedCloud Upsampler::measured(const OrganizedCloud& recorded) const {
  const bool has_other_columns = recorded.columns == columns_ && columns_ != recorded_.columns;
  OrganizedCloud cloud =
      has_other_columns ? project(returns_of(recorded), recorded_).cloud : recorded;
  if (!recorded_.elevation_correction_rad.empty()) cloud = calibrated(std::move(cloud), recorded_);
  return rows_ ? select_rows(cloud, *rows_) : cloud;
}

OrganizedCloud Upsampler::upsampled(const OrganizedCloud& measured,
                                    const nn::RecalledImage& recalled) {
  return method_ ? nn::upsampled_cloud(*method_, measured, recalled) : measured;
}

}  // namespace hqslam::pipeline

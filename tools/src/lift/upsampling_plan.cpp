#include "lift/upsampling_plan.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <utility>

#include "hqslam/core/error.h"
#include "hqslam/core/npy.h"
#include "hqslam/recordings/recording.h"
#include "recording/recording_sensor.h"

namespace hqslam::tools {
namespace {

constexpr double kDegreesPerRadian = 57.29577951308232;
/// Without --rows every fourth row is measured, if there are so many that this makes sense.
constexpr int kInterpolationFactor = 4;
constexpr int kFewestRowsToThin = 64;

/// Whether scans come from packets, whose columns can be chosen.
bool has_any_columns(const UpsamplingRequest& request) {
  return request.sender || recordings::is_capture_or_bag(request.input);
}

std::optional<SensorModel> sensor_of(const UpsamplingRequest& request) {
  if (request.sender) return request.sender;
  return recording_sensor(request.input, request.sensor, request.stream);
}

/// The rows that the files themselves have, where they tell.
std::optional<int> recorded_rows(const UpsamplingRequest& request) {
  if (request.sender) return std::nullopt;
  const std::string& input = request.input;
  if (std::filesystem::path(input).extension() == ".npy") {
    return NpyStackReader(input).rows();
  }
  const std::string sensor = file_of_drive(input, "sensor.json");
  return sensor.empty() ? std::nullopt : std::optional(load_sensor(sensor).rows());
}

[[noreturn]] void fail_for_sensor(const UpsamplingRequest& request, const SensorModel& found,
                                  const SensorModel& full, RowSelection measured_rows) {
  const SensorModel measured = select_rows(full, measured_rows);
  throw Error(fmt::format(
      "{}: expects scans of '{}' ({} x {}) or its rows {}, {}, ... alone ({} x {}), beams within "
      "{} degrees, but {} is of '{}' ({} x {}); give weights made for that sensor",
      request.method, full.name, full.rows(), full.columns, measured_rows.offset,
      measured_rows.offset + measured_rows.stride, measured.rows(), measured.columns,
      kBeamTolerance_deg, request.input, found.name, found.rows(), found.columns));
}

bool is_given(const ConfidenceChoice& choice) {
  return choice.least_confidence || choice.tolerance_m;
}

[[noreturn]] void fail_for_confidence(const UpsamplingRequest& request) {
  throw Error(
      fmt::format("{}: does not say how sure it is of a pixel; leave --confidence and --tolerance "
                  "out, or give weights of kind "
                  "du-mix",
                  request.method));
}

UpsamplingPlan plan_for_network(const UpsamplingRequest& request) {
  nn::SuperResolverOptions options = request.network_options;
  const ConfidenceChoice& choice = request.confidence;
  if (choice.least_confidence) options.least_confidence = choice.least_confidence;
  if (choice.tolerance_m) options.tolerance_m = *choice.tolerance_m;
  nn::SuperResolver network = nn::SuperResolver::load(request.method, options);
  if (is_given(choice) && !has_confidence(network.description())) {
    fail_for_confidence(request);
  }
  const SensorModel full = network.sensor();
  const RowSelection measured_rows = network.description().measured_rows;
  const SensorModel measured = select_rows(full, measured_rows);
  if (request.rows > 0 && request.rows != measured.rows()) {
    throw Error(fmt::format("{}: was made for {} measured rows, --rows asks for {}; leave it out",
                            request.method, measured.rows(), request.rows));
  }
  const std::optional<int> rows = recorded_rows(request);
  const bool measured_alone = rows == measured.rows();
  SensorModel recorded = sensor_of(request).value_or(measured_alone ? measured : full);
  if (has_any_columns(request)) recorded.columns = full.columns;
  if (!request.knows_sender_beams) {
    if (recorded.rows() == full.rows()) recorded = full;
    if (recorded.rows() == measured.rows()) recorded = measured;
  }
  if (measured_alone && recorded.rows() == full.rows()) {
    recorded = select_rows(recorded, measured_rows);
  }
  if (fits(recorded, full)) {
    return {recorded, measured_rows, nn::Upsampler(std::move(network), recorded)};
  }
  if (fits(recorded, measured)) {
    return {recorded, std::nullopt, nn::Upsampler(std::move(network), full)};
  }
  fail_for_sensor(request, recorded, full, measured_rows);
}

UpsamplingPlan plan_for_interpolation(const UpsamplingRequest& request) {
  if (is_given(request.confidence)) fail_for_confidence(request);
  const nn::Interpolation interpolation = nn::interpolation_from_name(request.method);
  const SensorModel full =
      request.sender ? *request.sender
                     : required_recording_sensor(request.input, request.sensor, request.stream);
  const int recorded = recorded_rows(request).value_or(full.rows());
  if (recorded < full.rows()) {
    const RowSelection measured_rows = selection_for(full.rows(), recorded);
    if (request.rows > 0 && request.rows != recorded) {
      throw Error(fmt::format("{}: has {} rows, --rows asks for {}; leave it out", request.input,
                              recorded, request.rows));
    }
    return {select_rows(full, measured_rows), std::nullopt,
            nn::Upsampler(interpolation, full, measured_rows)};
  }
  if (request.rows == 0 && full.rows() < kFewestRowsToThin) {
    throw Error(fmt::format(
        "{}: has all {} rows of sensor '{}', so there is nothing between them to fill; name the "
        "sensor with the rows to fill (os1-64 for scans of an os1-16), or say with hqslam run "
        "--rows how many of the {} to look at",
        request.input, full.rows(), full.name, full.rows()));
  }
  const RowSelection measured_rows = selection_for(
      full.rows(), request.rows > 0 ? request.rows : full.rows() / kInterpolationFactor);
  return {full, measured_rows, nn::Upsampler(interpolation, full, measured_rows)};
}

}  // namespace

bool fits(const SensorModel& sensor, const SensorModel& expected) {
  if (sensor.rows() != expected.rows() || sensor.columns != expected.columns) {
    return false;
  }
  for (int row = 0; row < sensor.rows(); ++row) {
    const double off_rad = sensor.beam_elevation_rad[row] - expected.beam_elevation_rad[row];
    if (std::abs(off_rad) * kDegreesPerRadian > kBeamTolerance_deg) {
      return false;
    }
  }
  return true;
}

UpsamplingPlan plan_upsampling(const UpsamplingRequest& request) {
  return nn::is_interpolation(request.method) ? plan_for_interpolation(request)
                                              : plan_for_network(request);
}

}  // namespace hqslam::tools

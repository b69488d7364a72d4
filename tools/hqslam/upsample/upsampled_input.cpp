#include "upsample/upsampled_input.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "hqslam/core/angles.h"
#include "hqslam/core/error.h"
#include "hqslam/core/npy.h"
#include "hqslam/nn/upsampled_cloud.h"
#include "hqslam/recordings/recording.h"

namespace hqslam::tools {
namespace {

/// Without --rows every fourth row is measured, if there are so many that this makes sense.
constexpr int kInterpolationFactor = 4;
constexpr int kFewestRowsToThin = 64;

/// What a user asked for.
struct Request {
  const InputChoice& recording;
  const UpsamplingChoice& upsampling;
  nn::SuperResolverOptions network = {};
  const Sender* sender = nullptr;             ///< of a sensor that sends now; nullptr: a recording
  std::optional<SensorModel> of_stream = {};  ///< of a capture or a bag

  const std::string& input() const { return sender != nullptr ? sender->name : recording.input; }
};

/// Whether scans come from packets, whose columns can be chosen.
bool has_any_columns(const Request& request) {
  return request.sender != nullptr || recordings::is_capture_or_bag(request.recording.input);
}

std::optional<SensorModel> sensor_of(const Request& request) {
  if (request.sender != nullptr) return request.sender->sensor;
  if (request.of_stream) return request.of_stream;
  return recording_sensor(request.recording);
}

SensorModel required_sensor_of(const Request& request) {
  if (const auto known = sensor_of(request)) return *known;
  return required_recording_sensor(request.recording);
}

/// The rows that the files themselves have, where they tell.
std::optional<int> recorded_rows(const Request& request) {
  if (request.sender != nullptr) return std::nullopt;
  const std::string& input = request.recording.input;
  if (std::filesystem::path(input).extension() == ".npy") return NpyStackReader(input).rows();
  const std::string sensor = file_of_drive(input, "sensor.json");
  return sensor.empty() ? std::nullopt : std::optional(load_sensor(sensor).rows());
}

/// Files of points, opened with the sensor that they tell of; nullptr for other recordings and
/// where they do not tell.
std::unique_ptr<ScanSource> opened_as_points_tell(const Request& request) {
  if (request.sender != nullptr || request.of_stream || recorded_rows(request)) return nullptr;
  try {
    return open_as_points_tell(request.recording);
  } catch (const Error&) {
    return nullptr;  // what is wrong with them is said when they are read
  }
}

/// That sensor, if its beams are those of the measured rows alone: points go into any columns.
std::optional<SensorModel> found_alone(const ScanSource* source, const SensorModel& measured) {
  if (source == nullptr) return std::nullopt;
  SensorModel found = source->sensor();
  found.columns = measured.columns;
  return fits(found, measured) ? std::optional(found) : std::nullopt;
}

/// Points of few beams, taken for those of many, would lie in wrong rows: whether the points tell
/// of other beams than the sensor's, and of less than half as many between their highest and
/// lowest.
bool has_few_beams(const ScanSource* source, const SensorModel& taken_for) {
  constexpr double kSameBeam_rad = 0.15 / kDegreesPerRadian;
  if (source == nullptr) return false;
  const std::vector<double>& found_rad = source->sensor().beam_elevation_rad;
  const std::vector<double>& rows_rad = taken_for.beam_elevation_rad;
  const auto between = std::ranges::count_if(rows_rad, [&](double row_rad) {
    return row_rad <= found_rad.front() && row_rad >= found_rad.back();
  });
  const auto is_a_row = [&](double beam_rad) {
    return std::ranges::any_of(
        rows_rad, [&](double row_rad) { return std::abs(row_rad - beam_rad) < kSameBeam_rad; });
  };
  return 2 * std::ssize(found_rad) < between && !std::ranges::all_of(found_rad, is_a_row);
}

[[noreturn]] void fail_for_sensor(const Request& request, const SensorModel& found,
                                  const SensorModel& full, RowSelection measured_rows) {
  const SensorModel measured = select_rows(full, measured_rows);
  throw Error(
      "{}: expects scans of '{}' ({} x {}) or its rows {}, {}, ... alone ({} x {}), beams within "
      "{} degrees, but {} is of '{}' ({} x {}); give weights made for that sensor, or name the "
      "sensor if it is another one",
      request.upsampling.upsample, full.name, full.rows(), full.columns, measured_rows.offset,
      measured_rows.offset + measured_rows.stride, measured.rows(), measured.columns,
      kBeamTolerance_deg, request.input(), found.name, found.rows(), found.columns);
}

/// In images of more columns than a turn has, gaps would be taken for the sky. Sensors do not keep
/// their speed to the percent.
void check_columns(const Request& request, int found, int expected) {
  constexpr double kFewestShare = 0.9;
  if (found >= kFewestShare * expected) return;
  throw Error(
      "{}: expects {} columns a turn, {} has {}; let the sensor turn more slowly, interpolate, or "
      "train for it (docs/training.md)",
      request.upsampling.upsample, expected, request.input(), found);
}

bool asks_for_confidence(const UpsamplingChoice& choice) {
  return choice.least_confidence || choice.tolerance_m;
}

[[noreturn]] void fail_for_confidence(const Request& request) {
  throw Error(
      "{}: does not say how sure it is of a pixel; leave --confidence and --tolerance out, or give "
      "weights of kind du-mix",
      request.upsampling.upsample);
}

UpsampledInput with_network(const Request& request) {
  nn::SuperResolverOptions options = request.network;
  const UpsamplingChoice& choice = request.upsampling;
  if (choice.least_confidence) options.least_confidence = choice.least_confidence;
  if (choice.tolerance_m) options.tolerance_m = *choice.tolerance_m;
  nn::SuperResolver network = nn::SuperResolver::load(choice.upsample, options);
  if (asks_for_confidence(choice) && !has_confidence(network.description())) {
    fail_for_confidence(request);
  }
  SensorModel full = network.sensor();
  const RowSelection measured_rows = network.description().measured_rows;
  const SensorModel measured = select_rows(full, measured_rows);
  if (choice.rows > 0 && choice.rows != measured.rows()) {
    throw Error("{}: was made for {} measured rows, --rows asks for {}; leave it out",
                choice.upsample, measured.rows(), choice.rows);
  }
  const auto source = opened_as_points_tell(request);
  const std::optional<SensorModel> found = found_alone(source.get(), measured);
  if (found && request.recording.sensor.empty()) print_later_warnings(*source, 0);
  const bool measured_alone = found || recorded_rows(request) == measured.rows();
  SensorModel recorded =
      sensor_of(request).value_or(measured_alone ? found.value_or(measured) : full);
  if (!measured_alone && has_few_beams(source.get(), recorded)) {
    fail_for_sensor(request, source->sensor(), full, measured_rows);
  }
  if (has_any_columns(request)) {
    check_columns(request, recorded.columns, full.columns);
    recorded.columns = full.columns;
  }
  if (request.sender != nullptr && !request.sender->knows_beams) {
    if (recorded.rows() == full.rows()) recorded = full;
    if (recorded.rows() == measured.rows()) recorded = measured;
  }
  if (measured_alone && recorded.rows() == full.rows()) {
    recorded = select_rows(recorded, measured_rows);
  }
  if (fits(recorded, full)) {
    return {{}, recorded, measured_rows, nn::Upsampler(std::move(network), recorded)};
  }
  if (fits(recorded, measured)) {
    full.scan_period_s = recorded.scan_period_s;
    full.min_range_m = recorded.min_range_m;
    full.max_range_m = recorded.max_range_m;
    return {{}, recorded, std::nullopt, nn::Upsampler(std::move(network), full)};
  }
  fail_for_sensor(request, recorded, full, measured_rows);
}

/// Of a recording for interpolation, whose sensor has all rows.
int recorded_rows_of(const Request& request, const SensorModel& full) {
  if (const auto rows = recorded_rows(request)) return *rows;
  const auto source = opened_as_points_tell(request);
  const int rows = source ? source->sensor().rows() : full.rows();
  const bool may_be_alone = full.rows() % rows == 0;
  const RowSelection measured_rows =
      selection_for(full.rows(), may_be_alone ? rows : full.rows() / kInterpolationFactor);
  if (may_be_alone && found_alone(source.get(), select_rows(full, measured_rows))) return rows;
  if (has_few_beams(source.get(), full)) {
    fail_for_sensor(request, source->sensor(), full, measured_rows);
  }
  return full.rows();
}

UpsampledInput with_interpolation(const Request& request) {
  const UpsamplingChoice& choice = request.upsampling;
  if (asks_for_confidence(choice)) fail_for_confidence(request);
  const nn::Interpolation interpolation = nn::interpolation_from_name(choice.upsample);
  const SensorModel full = required_sensor_of(request);
  const int recorded = recorded_rows_of(request, full);
  if (recorded < full.rows()) {
    const RowSelection measured_rows = selection_for(full.rows(), recorded);
    if (choice.rows > 0 && choice.rows != recorded) {
      throw Error("{}: has {} rows, --rows asks for {}; leave it out", request.input(), recorded,
                  choice.rows);
    }
    return {{},
            select_rows(full, measured_rows),
            std::nullopt,
            nn::Upsampler(interpolation, full, measured_rows)};
  }
  if (choice.rows == 0 && full.rows() < kFewestRowsToThin) {
    throw Error(
        "{}: has all {} rows of sensor '{}', so there is nothing between them to fill; name the "
        "sensor with the rows to fill (os1-64 for scans of an os1-16), or say with hqslam run "
        "--rows how many of the {} to look at",
        request.input(), full.rows(), full.name, full.rows());
  }
  const RowSelection measured_rows = selection_for(
      full.rows(), choice.rows > 0 ? choice.rows : full.rows() / kInterpolationFactor);
  return {{}, full, measured_rows, nn::Upsampler(interpolation, full, measured_rows)};
}

UpsampledInput as_measured(const Request& request) {
  UpsampledInput input{{}, required_sensor_of(request)};
  const int rows = input.recorded.rows();
  if (!request.recording.sensor.empty()) {
    const auto source = opened_as_points_tell(request);
    if (has_few_beams(source.get(), input.recorded)) {
      throw Error(
          "{}: expected scans of '{}' with {} rows, found beams of '{}' with {}; name the sensor "
          "that recorded them",
          request.input(), input.recorded.name, rows, source->sensor().name,
          source->sensor().rows());
    }
  }
  if (request.upsampling.rows > 0 && request.upsampling.rows != rows) {
    input.rows = selection_for(rows, request.upsampling.rows);
  }
  return input;
}

UpsampledInput upsampled_input(const Request& request) {
  const std::string& method = request.upsampling.upsample;
  UpsampledInput input = method.empty()                 ? as_measured(request)
                         : nn::is_interpolation(method) ? with_interpolation(request)
                                                        : with_network(request);
  input.recording = request.recording;
  return input;
}

}  // namespace

bool fits(const SensorModel& sensor, const SensorModel& expected) {
  if (sensor.rows() != expected.rows() || sensor.columns != expected.columns) return false;
  for (int row = 0; row < sensor.rows(); ++row) {
    const double off_rad = sensor.beam_elevation_rad[row] - expected.beam_elevation_rad[row];
    if (std::abs(off_rad) * kDegreesPerRadian > kBeamTolerance_deg) return false;
  }
  return true;
}

std::unique_ptr<ScanSource> UpsampledInput::open() {
  return with_imu_of(recording, opened ? std::move(opened) : open_input(recording, recorded));
}

OrganizedCloud UpsampledInput::measured(const OrganizedCloud& scan) const {
  if (recorded.elevation_correction_rad.empty()) return rows ? select_rows(scan, *rows) : scan;
  OrganizedCloud cloud = calibrated(scan, recorded);
  return rows ? select_rows(cloud, *rows) : cloud;
}

OrganizedCloud UpsampledInput::upsampled(const OrganizedCloud& measured,
                                         const nn::RecalledImage& recalled) {
  return upsampler ? nn::upsampled_cloud(*upsampler, measured, recalled) : measured;
}

SensorModel UpsampledInput::measuring() const {
  return rows ? select_rows(recorded, *rows) : recorded;
}

SensorModel UpsampledInput::seen() const { return upsampler ? upsampler->sensor() : measuring(); }

UpsampledInput upsampled_input(const InputChoice& recording, const UpsamplingChoice& upsampling,
                               const nn::SuperResolverOptions& network) {
  auto stream = open_stream(recording);
  Request request{recording, upsampling, network};
  if (stream) request.of_stream = stream->sensor();
  UpsampledInput input = upsampled_input(request);
  if (stream) {
    stream->use_columns(input.recorded.columns);
    input.opened = std::move(stream);
  }
  return input;
}

UpsampledInput upsampled_sender(const Sender& sender, const UpsamplingChoice& upsampling) {
  const InputChoice named{sender.name};
  return upsampled_input(Request{named, upsampling, {}, &sender});
}

}  // namespace hqslam::tools

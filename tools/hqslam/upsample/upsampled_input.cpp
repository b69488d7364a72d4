#include "upsample/upsampled_input.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "hqslam/core/angles.h"
#include "hqslam/core/error.h"
#include "hqslam/core/npy.h"
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
  return pipeline::fits(found, measured) ? std::optional(found) : std::nullopt;
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

[[noreturn]] void fail_for_confidence(const Request& request) {
  throw Error(
      "{}: gives no confidence; leave --confidence and --tolerance out, or give weights of kind "
      "du-mix",
      request.upsampling.upsample);
}

void check_confidence(const Request& request, const pipeline::UpsamplingMethod& method) {
  const UpsamplingChoice& choice = request.upsampling;
  if (!choice.least_confidence && !choice.tolerance_m) return;
  const auto* network = std::get_if<nn::SuperResolver>(&method);
  if (network == nullptr || !has_confidence(network->description())) fail_for_confidence(request);
}

[[noreturn]] void fail_for_sensor(const Request& request, const SensorModel& found,
                                  const SensorModel& full, RowSelection measured_rows) {
  pipeline::fail_for_sensor(found, full, measured_rows, request.upsampling.upsample,
                            request.input());
}

/// The recording's sensor for a network with this one.
SensorModel recorded_for_network(const Request& request, SensorModel full) {
  const RowSelection measured_rows = *full.measured_rows;
  full.measured_rows.reset();
  const SensorModel measured = select_rows(full, measured_rows);
  const auto source = opened_as_points_tell(request);
  const std::optional<SensorModel> found = found_alone(source.get(), measured);
  if (found && request.recording.sensor.empty()) print_later_warnings(*source, 0);
  const bool measured_alone = found || recorded_rows(request) == measured.rows();
  SensorModel recorded =
      sensor_of(request).value_or(measured_alone ? found.value_or(measured) : full);
  if (!measured_alone && has_few_beams(source.get(), recorded)) {
    fail_for_sensor(request, source->sensor(), full, measured_rows);
  }
  if (request.sender != nullptr && !request.sender->knows_beams) {
    for (const SensorModel& same_rows : {full, measured}) {
      if (recorded.rows() != same_rows.rows()) continue;
      recorded.beam_elevation_rad = same_rows.beam_elevation_rad;
      recorded.beam_azimuth_offset_rad = same_rows.beam_azimuth_offset_rad;
    }
  }
  if (measured_alone && recorded.rows() == full.rows()) {
    recorded = select_rows(recorded, measured_rows);
  }
  return recorded;
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

SensorModel recorded_as_measured(const Request& request) {
  SensorModel recorded = required_sensor_of(request);
  if (request.recording.sensor.empty()) return recorded;
  const auto source = opened_as_points_tell(request);
  if (has_few_beams(source.get(), recorded)) {
    throw Error(
        "{}: expected scans of '{}' with {} rows, found beams of '{}' with {}; name the sensor "
        "that recorded them",
        request.input(), recorded.name, recorded.rows(), source->sensor().name,
        source->sensor().rows());
  }
  return recorded;
}

pipeline::Upsampler upsampler_for(const Request& request) {
  const UpsamplingChoice& choice = request.upsampling;
  pipeline::UpsamplingOptions options{choice.upsample, choice.rows, {}, request.network};
  if (choice.least_confidence) options.network.least_confidence = choice.least_confidence;
  if (choice.tolerance_m) options.network.tolerance_m = *choice.tolerance_m;
  pipeline::UpsamplingMethod method = pipeline::load_method(options, sensor_of(request));
  check_confidence(request, method);
  SensorModel recorded;
  if (const std::optional<SensorModel> full = pipeline::sensor_of(method)) {
    recorded = recorded_for_network(request, *full);
  } else if (std::holds_alternative<nn::Interpolation>(method)) {
    options.all_rows = required_sensor_of(request);
    const int rows = recorded_rows_of(request, *options.all_rows);
    recorded = *options.all_rows;
    if (rows < recorded.rows()) {
      recorded = select_rows(recorded, selection_for(recorded.rows(), rows));
    }
  } else {
    recorded = recorded_as_measured(request);
  }
  return {recorded, std::move(method), options, request.input()};
}

}  // namespace

std::unique_ptr<ScanSource> UpsampledInput::open() {
  return with_imu_of(recording,
                     opened ? std::move(opened) : open_input(recording, upsampler.recorded()));
}

UpsampledInput upsampled_input(const InputChoice& recording, const UpsamplingChoice& upsampling,
                               const nn::SuperResolverOptions& network) {
  auto stream = open_stream(recording);
  Request request{recording, upsampling, network};
  if (stream) request.of_stream = stream->sensor();
  UpsampledInput input{recording, upsampler_for(request)};
  if (stream) {
    stream->use_columns(input.upsampler.recorded().columns);
    input.opened = std::move(stream);
  }
  return input;
}

pipeline::Upsampler upsampler_for_sender(const Sender& sender, const UpsamplingChoice& upsampling) {
  const InputChoice named{sender.name};
  return upsampler_for(Request{named, upsampling, {}, &sender});
}

}  // namespace hqslam::tools

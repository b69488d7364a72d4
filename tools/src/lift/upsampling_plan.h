#pragma once

#include <optional>
#include <string>

#include "hqslam/core/sensor_model.h"
#include "hqslam/nn/upsampler.h"
#include "recording/recording_choice.h"

namespace hqslam::tools {

/// Sensors of one type differ by this much from their data sheet.
inline constexpr double kBeamTolerance_deg = 0.25;
/// Whether a network made for `expected` can lift what `sensor` sees: as many rows and columns, and
/// beams that look the same way.
bool fits(const SensorModel& sensor, const SensorModel& expected);

/// What a user asked for.
struct UpsamplingRequest {
  std::string input;
  std::string sensor;  ///< empty: sensor.json in the recording's folder, or the weights' sensor
  std::string method;  ///< an interpolation's name or the path of a weights file
  int rows = 0;        ///< measured rows; 0: the weights', or for interpolation every fourth
  ConfidenceChoice confidence = {};
  nn::SuperResolverOptions network_options = {};
  std::string stream = "";  ///< of a capture or a bag; empty: the only one with scans
  /// Of a sensor that sends now: `input` is only its name then, `sensor` and `stream` are not
  /// looked at.
  std::optional<SensorModel> sender = std::nullopt;
  bool knows_sender_beams = true;  ///< false: they may turn out to be the weights'
};

/// How a recording gets its missing rows.
struct UpsamplingPlan {
  SensorModel recording_sensor;      ///< to open the recording with
  std::optional<RowSelection> rows;  ///< of the recording that are looked at; nothing: all of them
  nn::Upsampler upsampler;
};

/// A recording either has the measured rows alone or all rows of the sensor, of which the measured
/// ones are looked at. An .npy stack's own rows tell which; other recordings are of the sensor that
/// is named, or else of the weights'. The points of the result are those of the recording's own
/// sensor where it has all rows.
/// Throws Error, which says what the weights expect, for a sensor that they were not made for.
UpsamplingPlan plan_upsampling(const UpsamplingRequest& request);

}  // namespace hqslam::tools

#pragma once

#include <memory>
#include <optional>
#include <string>

#include "hqslam/core/scan_source.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/nn/upsampler.h"
#include "recording/recording_choice.h"
#include "recording/recording_sensor.h"
#include "run/slam_run.h"

namespace hqslam::tools {

/// A recording and what is made of its scans before they are used.
struct RecordingChoice : InputChoice, LiftingChoice {};
void declare_recording(CLI::App& command, RecordingChoice& choice);

/// The same, found to be possible.
struct RunPlan {
  InputChoice recording;
  SensorModel recording_sensor;
  std::optional<RowSelection> rows;
  std::optional<nn::Upsampler> upsampler;

  SlamRunSpec spec() {
    SlamRunSpec result;
    result.input = recording.input;
    result.rows = rows;
    result.upsampler = upsampler ? &*upsampler : nullptr;
    return result;
  }
  /// The recording from its beginning. Throws Error.
  std::unique_ptr<ScanSource> open();
  /// A capture or a bag that planning had to open: what open() gives first.
  std::unique_ptr<ScanSource> opened;
};
/// network: how its network is loaded; the choice's least_confidence comes first. Throws Error.
RunPlan plan_of(const RecordingChoice& choice, const nn::SuperResolverOptions& network = {});
/// The same for a sensor that sends now and can be read with any number of columns; it is called
/// `name` in messages. There is nothing to open. Not knows_beams: its beams may still turn out to
/// be those that a network was made for. Throws Error.
RunPlan plan_of(const LiftingChoice& choice, const SensorModel& sensor, const std::string& name,
                bool knows_beams = true);

}  // namespace hqslam::tools

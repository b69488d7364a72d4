#pragma once

#include <CLI/App.hpp>
#include <memory>
#include <optional>
#include <string>

#include "hqslam/core/scan_source.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/nn/upsampler.h"
#include "recording_sensor.h"
#include "slam_run.h"

namespace hqslam::tools {

/// A recording and what is made of its scans before they are used.
struct RecordingChoice {
  std::string input;
  std::string sensor;  ///< empty: what the recording says
  int rows = 0;        ///< 0: all
  std::string stream;  ///< of a capture or a bag; empty: the only one with scans
  std::string kept_return = "strongest";
  std::string row_order = "highest-first";
  bool motion_corrected = false;
  std::string capture;   ///< "rolling": points without a time have that of their azimuth
  std::string stamps;    ///< a file, or "names"; empty: what the recording says
  std::string upsample;  ///< weights file or interpolation; empty: the recording as it is
  std::optional<float> least_confidence;  ///< nothing: as the weights say
};
void declare_recording(CLI::App& command, RecordingChoice& choice);

/// The same, found to be possible.
struct RunPlan {
  InputRecording recording;
  SensorModel recording_sensor;
  std::optional<RowSelection> rows;
  std::optional<nn::Upsampler> upsampler;

  SlamRunSpec spec() { return {recording.input, rows, upsampler ? &*upsampler : nullptr}; }
  /// The recording from its beginning. Throws Error.
  std::unique_ptr<ScanSource> open() const;
};
/// network: how its network is loaded; the choice's least_confidence comes first. Throws Error.
RunPlan plan_of(const RecordingChoice& choice, const nn::SuperResolverOptions& network = {});

}  // namespace hqslam::tools

#pragma once

#include <CLI/App.hpp>
#include <memory>
#include <optional>
#include <string>

#include "hqslam/core/scan_source.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/nn/upsampler.h"
#include "slam_run.h"

namespace hqslam::tools {

/// A recording and what is made of its scans before they are used.
struct RecordingChoice {
  std::string input;
  std::string sensor;  ///< empty: sensor.json in a folder written by `hqslam simulate`
  int rows = 0;        ///< 0: all
  std::string row_order = "highest-first";
  bool motion_corrected = false;
  std::string upsample;  ///< weights file or interpolation; empty: the recording as it is
  std::optional<float> least_confidence;  ///< nothing: as the weights say
};
void declare_recording(CLI::App& command, RecordingChoice& choice);

/// The same, found to be possible.
struct RunPlan {
  std::string input;
  SensorModel recording_sensor;
  RecordingOptions recording_options;
  std::optional<RowSelection> rows;
  std::optional<nn::Upsampler> upsampler;

  SlamRunSpec spec() { return {input, rows, upsampler ? &*upsampler : nullptr}; }
  /// The recording from its beginning. Throws Error.
  std::unique_ptr<ScanSource> open() const;
};
/// network: how its network is loaded; the choice's least_confidence comes first. Throws Error.
RunPlan plan_of(const RecordingChoice& choice, const nn::SuperResolverOptions& network = {});

}  // namespace hqslam::tools

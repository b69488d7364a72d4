#pragma once

#include <memory>
#include <optional>
#include <string>

#include "hqslam/core/scan_source.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/pipeline/upsampler.h"
#include "recording/recording_choice.h"

namespace hqslam::tools {

/// A recording, and what upsamples its scans.
struct UpsampledInput {
  InputChoice recording;
  pipeline::Upsampler upsampler;

  /// A capture or a bag that had to be opened to know its sensor: what open() gives first.
  std::unique_ptr<ScanSource> opened = {};

  /// The recording from its beginning. Throws Error.
  std::unique_ptr<ScanSource> open();
};

/// A recording either has the measured rows alone or all rows of the sensor, of which the measured
/// ones are looked at. An .npy stack's own rows tell which, or the beams in files of points; other
/// recordings are of the sensor that is named, or else of the weights'. The points of what is
/// upsampled are those of the recording's own sensor where it has all rows. network: how a network
/// is loaded; what `upsampling` says comes first. Throws Error, which says what the weights expect,
/// for a sensor that they were not made for.
UpsampledInput upsampled_input(const InputChoice& recording, const UpsamplingChoice& upsampling,
                               const nn::SuperResolverOptions& network = {});

/// A sensor that sends now and can be read with any number of columns.
struct Sender {
  std::string name;  ///< in messages
  SensorModel sensor;
  bool knows_beams = true;  ///< false: they may still turn out to be those that a network wants
};
/// What upsamples its scans. Throws Error.
pipeline::Upsampler upsampler_for_sender(const Sender& sender, const UpsamplingChoice& upsampling);

}  // namespace hqslam::tools

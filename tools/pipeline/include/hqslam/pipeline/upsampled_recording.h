#pragma once

#include <string>

#include "hqslam/pipeline/upsampler.h"
#include "hqslam/recordings/recording.h"

namespace hqslam::pipeline {

/// A recording and what upsamples its scans.
struct UpsampledRecording {
  std::string path;
  recordings::OpenOptions options;  ///< as determined when it was opened
  recordings::Recording recording;  ///< in the columns of upsampler.recorded()
  Upsampler upsampler;

  /// The recording from its beginning. Throws Error.
  recordings::Recording reopened() const { return recordings::Recording::open(path, options); }
};

/// Opens a recording for an upsampling: it has all rows of the sensor or the measured ones alone,
/// and is put into the columns that the method needs. Weights name the sensor where the recording
/// does not; weights of a name are chosen by its sensor. Throws Error.
UpsampledRecording open_upsampled(const std::string& path, recordings::OpenOptions options = {},
                                  UpsamplingOptions upsampling = {});

}  // namespace hqslam::pipeline

#pragma once

#include <memory>
#include <optional>
#include <string>

#include "hqslam/core/scan_source.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/nn/upsampler.h"
#include "recording/recording_choice.h"

namespace hqslam::tools {

/// Sensors of one type differ by this much from their data sheet.
/// Whether a network made for `expected` can upsample what `sensor` sees: as many rows and columns,
/// and beams that look the same way.
bool fits(const SensorModel& sensor, const SensorModel& expected);

/// A recording, or a sensor that sends now, and what is made of its scans before they are used.
struct UpsampledInput {
  InputChoice recording;                  ///< of a sensor that sends now only its name, as `input`
  SensorModel recorded;                   ///< to open the recording with
  std::optional<RowSelection> rows = {};  ///< that are looked at; nothing: all of them
  std::optional<nn::Upsampler> upsampler = {};  ///< fills the rows between them; nothing: none

  /// A capture or a bag that had to be opened to know its sensor: what open() gives first.
  std::unique_ptr<ScanSource> opened = {};

  /// The recording from its beginning. Throws Error.
  std::unique_ptr<ScanSource> open();
  /// The rows of a recorded scan that are looked at.
  OrganizedCloud measured(const OrganizedCloud& scan) const;
  /// What is used of them: with the rows between them filled, if anything fills them. recalled: of
  /// a network with a memory (DriveMemory).
  OrganizedCloud upsampled(const OrganizedCloud& measured, const nn::RecalledImage& recalled = {});
  const nn::Upsampler* upsampler_or_null() const { return upsampler ? &*upsampler : nullptr; }
  /// Behind what `measured` returns.
  SensorModel measuring() const;
  /// Behind what `upsampled` returns.
  SensorModel seen() const;
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
/// The same of one; there is nothing to open.
UpsampledInput upsampled_sender(const Sender& sender, const UpsamplingChoice& upsampling);

}  // namespace hqslam::tools

#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "hqslam/slam/sensor_path.h"
#include "recording/reading.h"
#include "recording/recording_choice.h"
#include "recording/scan_poses.h"
#include "terminal/terminal.h"

namespace hqslam::tools {

/// One reading of all scans whose pose may be known.
struct MapReading : Reading {
  std::int64_t scans = 0;         ///< with a pose that is known
  std::int64_t without_pose = 0;  ///< the others
};

/// A recording of which a map is made: it is read several times, with the poses that are known when
/// the drive is over, and none of its scans is kept. A network is asked for all points that it
/// keeps, with the probability that they are within a voxel of the truth: the map
/// decides, not the network's operating point.
class MapInput {
 public:
  /// Throws Error.
  MapInput(const InputChoice& recording, const UpsamplingChoice& upsampling, double voxel_m);

  using Use = std::function<void(const OrganizedCloud& scan, const slam::SensorPath& path)>;
  /// Calls use(scan, path) for every scan whose pose is known, with its measured pixels alone.
  /// Shows progress on stderr. A scan that cannot be read ends each reading at the same place.
  MapReading read_measured(const ScanPoses& poses, const std::string& label,
                           const InterruptGuard& interrupt, const Use& use);
  /// Calls use(scan, path) in the same way, with the computed pixels too.
  MapReading read_upsampled(const ScanPoses& poses, const std::string& label,
                            const InterruptGuard& interrupt, const Use& use);

  /// The sensor of the scans of read_measured().
  SensorModel measuring() const;
  /// Which rows of the scans of read_upsampled() are measured; nothing: all.
  const std::optional<RowSelection>& measured_rows() const { return measured_rows_; }

 private:
  /// Whether the recording itself has computed rows.
  bool is_partly_computed() const { return !input_.upsampler.method() && measured_rows_; }
  pipeline::Upsampler& upsampler() { return input_.upsampler; }
  MapReading read(const ScanPoses& poses, const std::string& label, const InterruptGuard& interrupt,
                  const std::function<void(const ReadScan&, const slam::SensorPath&)>& use,
                  const LookAhead& look_ahead);

  pipeline::UpsampledRecording input_;
  ScanRange wanted_;
  std::optional<RowSelection> measured_rows_;
};

}  // namespace hqslam::tools

#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "hqslam/slam/sensor_path.h"
#include "lift/drive_memory.h"
#include "lift/lifted_input.h"
#include "recording/reading.h"
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
/// believes in at all, and how sure it is that they lie within a voxel of the truth: the map
/// decides, not the network's operating point.
class MapInput {
 public:
  /// Throws Error.
  MapInput(const InputChoice& recording, const LiftingChoice& lifting, double voxel_m);

  /// Calls use(scan, path) for every scan whose pose is known. Shows progress on stderr. A scan
  /// that cannot be read ends each reading at the same place.
  MapReading read_all(const ScanPoses& poses, const std::string& label,
                      const InterruptGuard& interrupt,
                      const std::function<void(const RecordedScan&, const slam::SensorPath&)>& use);

  /// A scan's measured pixels alone.
  OrganizedCloud measured(const RecordedScan& scan) const;
  /// Behind what `measured` returns.
  SensorModel measuring() const;
  /// All pixels that there are of it. In one reading, scan after scan: it remembers them.
  OrganizedCloud lifted(const RecordedScan& scan, const slam::SensorPath& path);
  /// Of what `lifted` returns; nothing: all of them.
  const std::optional<RowSelection>& measured_rows() const { return measured_rows_; }

 private:
  /// Whether the recording itself has computed rows.
  bool is_partly_computed() const { return !input_.upsampler && measured_rows_; }

  LiftedInput input_;
  std::optional<RowSelection> measured_rows_;
  DriveMemory memory_;
};

}  // namespace hqslam::tools

#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "hqslam/core/sensor_model.h"
#include "laboratory/table/table_plan.h"
#include "laboratory/table/table_result.h"
#include "terminal/interrupt.h"

namespace hqslam::tools {

/// Methods that share one pass of upsampling over one drive.
struct TablePass {
  TableDrive drive;
  SensorModel sensor;  ///< of the recording
  std::vector<TableMethod> methods;
  std::vector<TableSettings> settings;  ///< of each
  std::int64_t scans = 0;               ///< of the recording that are used
  bool loop_closing = true;             ///< whether SLAM also runs with it
  std::int64_t scored_scans = 0;        ///< at most; see run_pass
};

/// Streams the drive once through the upsampling and hands every scan to SLAM, for each method
/// without and, if the pass asks for it, with loop closing. Calls `on_scan` after each scan. Times
/// are taken around upsampling, around making points of its result and around each SLAM alone;
/// reading, scoring and writing are in none of them. At most `scored_scans` scans, evenly spread,
/// are compared with the recording's own rows. What cannot be understood is left out and counted.
/// Returns nothing if it was interrupted. Throws Error, also if nothing could be used.
std::vector<TableResult> run_pass(const TablePass& pass, const InterruptGuard& interrupt,
                                  const std::function<void()>& on_scan);
inline constexpr std::int64_t kMostScoredScans = 200;
inline constexpr std::int64_t kScoredPerSeed = 20;  ///< of each of many drives

}  // namespace hqslam::tools

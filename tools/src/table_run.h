#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hqslam/core/sensor_model.h"
#include "interrupt.h"
#include "table_plan.h"
#include "table_result.h"

namespace hqslam::tools {

/// Methods that share one pass of upsampling over one drive.
struct TablePass {
  TableDrive drive;
  SensorModel sensor;  ///< of the recording
  std::vector<TableMethod> methods;
  std::vector<TableSettings> settings;  ///< of each
  std::int64_t scans = 0;               ///< of the recording that are used
  std::string title;                    ///< of the progress
};

/// Streams the drive once through the upsampling and hands every scan to two SLAM instances per
/// method, without and with loop closing. Times are taken around upsampling, around making points
/// of its result and around each SLAM alone; reading, scoring and writing are in none of them.
/// At most so many scans, evenly spread, are compared with the recording's own rows.
/// Returns nothing if it was interrupted. Throws Error.
std::vector<TableResult> run_pass(const TablePass& pass, const InterruptGuard& interrupt);
inline constexpr std::int64_t kMostScoredScans = 200;

}  // namespace hqslam::tools

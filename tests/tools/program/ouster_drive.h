#pragma once

#include <string>
#include <vector>

#include "core/recordings/captures.h"

namespace hqslam::test {

/// A simulated drive as an Ouster would have sent it: packets of the legacy layout.
struct OusterDrive {
  std::string metadata;           ///< of the sensor, as text
  std::vector<Captured> packets;  ///< captured at the times of their columns, from 0 on
};

/// folder: written by `hqslam-lab simulate` for an os1-16 or os1-64.
OusterDrive ouster_drive(const std::string& folder);

}  // namespace hqslam::test

#pragma once

#include <Eigen/Geometry>

#include "hqslam/core/angles.h"
#include "opened_files.h"
#include "testing.h"

// Folders of point files of a VLP-16.
namespace hqslam::test {

/// A scan as a .txt file without names: points 5 m away, `turn_deg` degrees clockwise from
/// `first_deg` on, ring numbers from below.
inline std::string firing_order(double first_deg, double turn_deg, double off_deg = 0.0,
                                double pitch_deg = 0.0) {
  const Eigen::AngleAxisd pitch(radians(pitch_deg), Eigen::Vector3d::UnitY());
  std::string text;
  for (int i = 0; i * 0.5 < turn_deg; ++i) {
    for (int ring = 0; ring < 16; ++ring) {
      const Eigen::Vector3d p_m =
          5.0 * (pitch * direction_of(-radians(first_deg + 0.5 * i),
                                      radians(-15.0 + 2.0 * ring + off_deg)));
      text += fmt::format("{:.6f} {:.6f} {:.6f} 7 {}\n", p_m.x(), p_m.y(), p_m.z(), ring);
    }
  }
  return text;
}

/// The files 0.txt, 1.txt and so on.
inline void write_scans(const TemporaryDirectory& folder, int scans,
                        const std::function<std::string(int scan)>& contents) {
  for (int i = 0; i < scans; ++i) write_file(folder.file(fmt::format("{}.txt", i)), contents(i));
}

inline std::unique_ptr<ScanSource> open_vlp16(
    const TemporaryDirectory& folder, std::optional<CaptureTime> capture = CaptureTime::kRolling,
    const SensorModel& sensor = sensor_preset("vlp-16")) {
  return open_scan_files(folder.path(), sensor, {.capture = capture});
}

/// Of all scans, to the last one.
inline std::vector<double> stamps_s(ScanSource& source) {
  std::vector<double> result;
  while (const auto scan = source.next()) result.push_back(scan->stamp_s);
  return result;
}

}  // namespace hqslam::test

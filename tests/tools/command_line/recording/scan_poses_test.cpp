#include "recording/scan_poses.h"

#include "made_scans.h"

namespace hqslam::tools {
namespace {

constexpr double kPeriod_s = 0.1;

Pose at(double time_s) { return Pose(Eigen::Translation3d(20.0 * time_s, 0.0, 0.0)); }

}  // namespace

TEST_CASE("poses without stamps get those of the scans, whatever the scans' intervals") {
  const TemporaryDirectory folder;
  // As a sensor that is carried: three scans half a second apart, one that is broken, and another.
  const std::vector<double> stamps_s = {0.05, 0.55, 1.05, -1.0, 2.05};
  Trajectory trajectory;
  for (const double stamp_s : stamps_s) trajectory.push_back({0.0, at(stamp_s)});
  write_kitti_poses(trajectory, folder.file("poses.kitti"));
  const InterruptGuard interrupt;
  const auto open = [&] {
    return std::make_unique<MadeScans>(stamps_s.size(), [&](std::size_t i) {
      if (stamps_s[i] < 0.0) throw ScanError("is broken");
      RecordedScan scan;
      scan.stamp_s = stamps_s[i];
      return scan;
    });
  };
  const ScanPoses poses = read_scan_poses(folder.file("poses.kitti"), interrupt, open);
  for (const std::int64_t scan : {0, 1, 2, 4}) {
    const double stamp_s = stamps_s[static_cast<std::size_t>(scan)];
    const auto path = poses.path_of(scan, stamp_s, kPeriod_s).value();
    CHECK(path.at(0.04).isApprox(at(stamp_s + 0.04), 1e-6));
  }
  CHECK_FALSE(poses.path_of(3, 1.55, kPeriod_s));
  const auto open_fewer = [] { return std::make_unique<MadeScans>(scans_at({0.0, 0.1})); };
  CHECK(refused_with([&] { read_scan_poses(folder.file("poses.kitti"), interrupt, open_fewer); },
                     "has 5 poses without stamps, but the recording has 2 scans"));
}

}  // namespace hqslam::tools

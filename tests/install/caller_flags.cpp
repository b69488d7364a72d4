// What a program sees of the libraries: sizes and places of what their structures hold, and what
// SLAM finds. install_test.sh compiles it with several -m flags; what it prints must be the same.

#include <hqslam/core/projection.h>
#include <hqslam/core/trajectory.h>
#include <hqslam/slam/beam_calibration.h>
#include <hqslam/slam/occupancy_grid.h>
#include <hqslam/slam/saved_map.h>
#include <hqslam/slam/scan_trace.h>
#include <hqslam/slam/slam.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <cmath>
#include <cstddef>
#include <cstdio>

#include "slam/yard_drive.h"

using namespace hqslam;

namespace {

#define SHOW(type, member) \
  std::printf("%s.%s at %zu of %zu\n", #type, #member, offsetof(type, member), sizeof(type))

void show_layout() {
  std::printf("Pose %zu aligned to %zu\n", sizeof(Pose), alignof(Pose));
  SHOW(StampedPose, T_map_sensor);
  SHOW(slam::LocatedScan, velocity);
  SHOW(slam::OccupancyMap, rows);
  SHOW(slam::SavedPlace, context);
  SHOW(slam::ScanContext, seen);
  SHOW(slam::ScanReport, covariance);
  SHOW(slam::ScanReport, velocity_covariance);
  SHOW(slam::ScanReport, times);
  SHOW(slam::ScanTrace, direction);
  SHOW(slam::ScanTrace, degenerate_directions);
}

/// A scan of the drive, the same with any arithmetic: to 1/256 m.
OrganizedCloud scan(const SensorModel& sensor, int i) {
  RangeImage image = range_image(test::drive_scan(sensor, i));
  for (float& range_m : image.range_m) range_m = std::round(256.0F * range_m) / 256.0F;
  return unproject(image, sensor, CaptureTime::kRolling);
}

template <typename Numbers>
void show(const char* name, const Numbers& numbers) {
  std::printf("%s", name);
  for (Eigen::Index i = 0; i < numbers.size(); ++i) std::printf(" %a", numbers.data()[i]);
  std::printf("\n");
}

/// What SLAM itself does with Eigen, done by the caller with its own flags, too: the linker must
/// not put one in the place of the other.
template <int kSize>
double solved(const slam::Covariance& covariance) {
  using Square = Eigen::Matrix<double, kSize, kSize>;
  Square matrix = Square::Identity();
  matrix.template topLeftCorner<6, 6>() += covariance;
  const Eigen::SelfAdjointEigenSolver<Square> eigen(matrix);
  const Eigen::JacobiSVD<Square> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Square inverse = matrix.ldlt().solve(Square::Identity());
  return eigen.eigenvalues().sum() + svd.singularValues().sum() + (inverse * matrix).trace();
}

}  // namespace

int main() {
  show_layout();
  const SensorModel sensor = test::small_sensor(16, 256);
  slam::Slam slam(sensor);
  double checked = 0.0;
  for (int i = 0; i < 12; ++i) {
    slam::ScanTrace trace;
    const slam::ScanReport report = slam.process(scan(sensor, i), 0.1 * i, &trace);
    show("covariance", report.covariance);
    show("direction", trace.direction);
    checked += solved<6>(report.covariance) + solved<12>(report.covariance);
  }
  slam.finish();
  Trajectory trajectory = slam.trajectory();
  trajectory.push_back(trajectory.front());
  for (const StampedPose& pose : trajectory) show("pose", pose.T_map_sensor.matrix());
  slam::SavedMap map = slam.saved_map();
  map.places.push_back(map.places.front());
  show("context", map.places.back().context.unit_sectors);
  return std::isfinite(checked) ? 0 : 1;
}

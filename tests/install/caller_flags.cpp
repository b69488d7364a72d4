// What a program sees of the libraries: sizes and places of what their structures hold, and what
// SLAM finds. install_test.sh compiles it with several -m flags; what it prints must be the same.

#include <hqslam/core/projection.h>
#include <hqslam/core/trajectory.h>
#include <hqslam/nn/network.h>
#include <hqslam/nn/network_json.h>
#include <hqslam/nn/trace.h>
#include <hqslam/slam/beam_calibration.h>
#include <hqslam/slam/occupancy_grid.h>
#include <hqslam/slam/saved_map.h>
#include <hqslam/slam/scan_trace.h>
#include <hqslam/slam/slam.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>

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
  SHOW(slam::ScanContext, has_returns);
  SHOW(slam::ScanReport, covariance);
  SHOW(slam::ScanReport, velocity_covariance);
  SHOW(slam::ScanReport, times);
  SHOW(slam::ScanTrace, direction);
  SHOW(slam::ScanTrace, degenerate_directions);
}

SensorModel small_sensor() {
  SensorModel sensor;
  sensor.name = "small";
  sensor.columns = 256;
  for (int row = 0; row < 16; ++row) {
    sensor.beam_elevation_rad.push_back(0.17 - 0.43 * row / 15);
    sensor.beam_azimuth_offset_rad.push_back(0.0);
  }
  return sensor;
}

/// Scan `i` of a drive along x through a hall of 60 m x 40 m with square pillars. Ranges are
/// rounded to 1/256 m, so that they are the same with any arithmetic.
OrganizedCloud scan(const SensorModel& sensor, int i) {
  const double x_m = -10.0 + 0.5 * i;
  RangeImage image(sensor.rows(), sensor.columns);
  for (int row = 0; row < sensor.rows(); ++row) {
    for (int column = 0; column < sensor.columns; ++column) {
      const double level = std::cos(sensor.beam_elevation_rad[row]);
      const double u = level * std::cos(sensor.azimuth_rad(row, column));
      const double v = level * std::sin(sensor.azimuth_rad(row, column));
      const double w = std::sin(sensor.beam_elevation_rad[row]);
      double range_m = std::min(((u > 0.0 ? 30.0 : -30.0) - x_m) / u, 20.0 / std::abs(v));
      if (w < 0.0) range_m = std::min(range_m, -1.7 / w);
      for (int k = 0; k < 10; ++k) {
        const double along_m = 5.0 * k - 22.0 - x_m;
        const double across_m = (k % 2 == 0 ? 6.0 : -8.0) + 0.3 * k;
        const double a = along_m / u;
        const double b = (along_m + 0.6) / u;
        const double c = across_m / v;
        const double d = (across_m + 0.6) / v;
        const double enter_m = std::max(std::min(a, b), std::min(c, d));
        const bool is_hit = enter_m > 0.0 && enter_m < std::min(std::max(a, b), std::max(c, d));
        if (is_hit) range_m = std::min(range_m, enter_m);
      }
      image.at(row, column) = static_cast<float>(std::round(256.0 * range_m) / 256.0);
    }
  }
  return unproject(image, sensor, CaptureTime::kMotionCorrected);
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

/// A trace of a network is copied, changed and freed by the caller.
void show_trace() {
  const nn::NetworkDescription description = nn::network_from_json(
      R"({"kind": "du-or", "sensor": "os1-64", "measured_rows": 16, "layers": 1})", "caller");
  const auto network = nn::make_network(description, 64, nn::InstructionSet::kPortable, 1);
  network->set_parameters(nn::initial_parameters(description, 1));
  nn::Trace trace = network->trace(RangeImage(16, 64));
  const nn::Trace copied = trace;
  for (nn::TracedTensor longer : copied.tensors()) {
    longer.values.resize(longer.channels() + 1, longer.rows(), longer.columns());
    longer.values.setZero();
    trace.add(std::move(longer));
  }
  std::printf("tensors %zu of %zu\n", trace.tensors().size(), copied.tensors().size());
}

}  // namespace

int main() {
  show_layout();
  show_trace();
  const SensorModel sensor = small_sensor();
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

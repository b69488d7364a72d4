#include "train/drive_recall.h"

#include <cmath>

#include "hqslam/core/projection.h"

namespace hqslam::tools {
namespace {

/// Errors of SLAM's poses, standard deviations on each axis: of each scan in the memory, and of the
/// present scan, whose pose may be registered or only predicted (a tenth to all of kPredicted).
/// Measured on `town` and `hills` with 16 rows and typical beam errors: registered over ten scans
/// 4 to 12 mm and 0.02 degrees, predicted 12 to 17 mm and 0.03 to 0.06 degrees.
constexpr double kKeptError_m = 0.003;
constexpr double kKeptError_rad = 0.0002;
constexpr double kPredictedError_m = 0.02;
constexpr double kPredictedError_rad = 0.0012;
constexpr double kLeastOfPredicted = 0.1;

double uniform(std::mt19937_64& random) { return static_cast<double>(random() >> 11) * 0x1p-53; }

/// The poses of a scan with an error: a small motion that is the same for all of them.
nn::ColumnPoses with_error(const nn::ColumnPoses& poses, double error_m, double error_rad,
                           std::mt19937_64& random) {
  const auto off = [&](double sigma) {  // the sum of twelve uniform numbers is nearly normal
    double sum = -6.0;
    for (int i = 0; i < 12; ++i) sum += uniform(random);
    return sigma * sum;
  };
  Twist error;
  for (int axis = 0; axis < 3; ++axis) {
    error.linear[axis] = off(error_m);
    error.angular[axis] = off(error_rad);
  }
  const Pose T_right_off = exponential(error);
  nn::ColumnPoses result;
  for (const Pose& pose : poses) result.push_back(pose * T_right_off);
  return result;
}

SensorModel measured_by(SensorModel sensor, RowSelection rows) {
  sensor.measured_rows = rows;
  return sensor;
}

}  // namespace

DriveRecall::DriveRecall(const SensorModel& sensor, RowSelection rows, bool look_ahead,
                         std::uint64_t seed)
    : rows_(rows),
      look_ahead_scans_(look_ahead ? nn::kLookAheadScans : 0),
      sensor_(select_rows(sensor, rows)),
      memory_(measured_by(sensor, rows),
              look_ahead ? nn::kLookAheadMemory : nn::ScanMemoryOptions{}),
      random_(seed) {}

void DriveRecall::want(const sim::SimulatedScan& scan) { wanted_.push_back({scan}); }

void DriveRecall::add(const sim::SimulatedScan& scan) {
  memory_.insert(unproject(select_rows(scan.image, rows_), sensor_, CaptureTime::kRolling),
                 with_error(scan.T_map_sensor_at_column, kKeptError_m, kKeptError_rad, random_),
                 scan.stamp_s);
  for (Wanted& wanted : wanted_) {
    if (wanted.scan.stamp_s != scan.stamp_s) ++wanted.later;
  }
}

std::optional<RangeImage> DriveRecall::finished(bool is_last) {
  if (wanted_.empty()) return std::nullopt;
  if (wanted_.front().later < look_ahead_scans_ && !is_last) return std::nullopt;
  RangeImage image = with_recalled(wanted_.front().scan);
  wanted_.pop_front();
  return image;
}

RangeImage DriveRecall::with_recalled(const sim::SimulatedScan& scan) {
  const double error_share = std::pow(kLeastOfPredicted, uniform(random_));
  const nn::RecalledImage recalled =
      memory_.recall(select_rows(scan.image, rows_),
                     with_error(scan.T_map_sensor_at_column, error_share * kPredictedError_m,
                                error_share * kPredictedError_rad, random_),
                     scan.stamp_s);
  RangeImage image = scan.image;
  const std::size_t pixels = image.range_m.size();
  if (!recalled.is_empty()) {
    image.range_m.insert(image.range_m.end(), recalled.image.range_m.begin(),
                         recalled.image.range_m.end());
    image.range_m.insert(image.range_m.end(), recalled.weight.begin(), recalled.weight.end());
  }
  image.range_m.resize(3 * pixels);
  image.rows *= 3;
  return image;
}

}  // namespace hqslam::tools

#include "info/capture_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <vector>

#include "hqslam/core/median.h"
#include "hqslam/slam/scan_trace.h"
#include "hqslam/slam/slam.h"
#include "recording/reading.h"
#include "recording/recording_choice.h"
#include "terminal/progress.h"

namespace hqslam::tools {
namespace {

constexpr std::int64_t kMostScans = 100;
constexpr int kFewestScans = 15;
/// In a turn, as far as a point 10 m away moves.
constexpr double kMoved_m = 0.1;
constexpr double kLever_m = 10.0;
constexpr std::size_t kFewestFeatures = 20;
constexpr double kClear = 2.5;

struct ScanFit {
  double moved_m = 0.0;
  std::optional<double> distance_m;
};

std::optional<double> median_distance_m(const slam::ScanTrace& trace) {
  std::vector<double> distances_m;
  for (const slam::TracedFeature& feature : trace.features) {
    if (feature.is_matched && feature.kind != slam::FeatureKind::kGround) {
      distances_m.push_back(std::abs(feature.residual_m));
    }
  }
  if (distances_m.size() < kFewestFeatures) return std::nullopt;
  return median(std::move(distances_m));
}

std::vector<ScanFit> fits(const std::string& input, const SensorModel& sensor,
                          recordings::OpenOptions options, CaptureTime capture_time) {
  if (options.sensor.empty()) options.all_rows = sensor;
  if (input.ends_with(".npy") || !file_of_drive(input, "scans.npy").empty()) {
    options.files.capture_time = capture_time;
  } else {
    options.files.without_times = capture_time;
  }
  auto source = recordings::Recording::open(input, options);
  slam::Slam slam(source.sensor());
  LeftOut left_out;
  std::vector<ScanFit> result;
  const bool is_rolling = capture_time == CaptureTime::kRolling;
  Progress progress(fmt::format("test of --capture {}", is_rolling ? "rolling" : "corrected"),
                    std::min(kMostScans, source.size().value_or(kMostScans)));
  while (std::ssize(result) < kMostScans) {
    const auto scan = next_usable(source, left_out);
    if (!scan) break;
    slam::ScanTrace trace;
    const Twist velocity = slam.process(scan->cloud, scan->stamp_s, &trace).velocity;
    result.push_back(
        {(velocity.linear.norm() + kLever_m * velocity.angular.norm()) * sensor.scan_period_s,
         median_distance_m(trace)});
    progress.update(std::ssize(result));
  }
  progress.finish();
  return result;
}

}  // namespace

CaptureCheck check_capture(const std::string& input, const SensorModel& sensor,
                           recordings::OpenOptions options) {
  const std::vector<ScanFit> rolling = fits(input, sensor, options, CaptureTime::kRolling);
  const std::vector<ScanFit> corrected =
      fits(input, sensor, options, CaptureTime::kMotionCorrected);
  CaptureCheck check;
  double sum = 0.0;
  double sum_of_squares = 0.0;
  for (std::size_t i = 0; i < std::min(rolling.size(), corrected.size()); ++i) {
    const bool is_moved = std::min(rolling[i].moved_m, corrected[i].moved_m) > kMoved_m;
    if (!is_moved || !rolling[i].distance_m || !corrected[i].distance_m) continue;
    const double log_ratio = std::log(*rolling[i].distance_m / *corrected[i].distance_m);
    sum += log_ratio;
    sum_of_squares += log_ratio * log_ratio;
    check.rolling_m += *rolling[i].distance_m;
    check.corrected_m += *corrected[i].distance_m;
    ++check.scans;
  }
  if (check.scans == 0) return check;
  check.rolling_m /= check.scans;
  check.corrected_m /= check.scans;
  const double mean = sum / check.scans;
  const double variance = sum_of_squares / check.scans - mean * mean;
  const bool is_clear = std::abs(mean) > kClear * std::sqrt(variance / check.scans);
  if (check.scans >= kFewestScans && is_clear) {
    check.verdict = mean < 0.0 ? CaptureTime::kRolling : CaptureTime::kMotionCorrected;
  }
  return check;
}

std::optional<CaptureCheck> check_clouds_without_times(const std::string& input,
                                                       const recordings::OpenOptions& options) {
  const bool can_be_read_twice =
      std::filesystem::is_regular_file(input) || std::filesystem::is_directory(input);
  if (!can_be_read_twice || options.files.without_times) return std::nullopt;
  try {
    auto source = recordings::Recording::open(input, options);
    LeftOut left_out;
    const auto first = next_usable(source, left_out);
    if (!first || !first->cloud.time_offset_s.empty() || source.sensor().motion_corrected) {
      return std::nullopt;
    }
    CaptureCheck check = check_capture(input, source.sensor(), options);
    check.is_of_kitti = first->name.ends_with(".bin");
    return check;
  } catch (const Error&) {
    return std::nullopt;  // whoever reads the recording reports it
  }
}

std::string fit_text(const CaptureCheck& check) {
  return fmt::format(
      "{} scans that moved fit each other within {:.1f} mm as captured while the sensor turned, "
      "within {:.1f} mm as corrected for motion",
      check.scans, 1e3 * check.rolling_m, 1e3 * check.corrected_m);
}

}  // namespace hqslam::tools

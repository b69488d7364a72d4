#include "recording/capture_check.h"

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

constexpr std::int64_t kMostTestedScans = 100;
constexpr int kFewestTestedScans = 15;
/// In a turn, as far as a point 10 m away moves.
constexpr double kMoved_m = 0.1;
constexpr double kLever_m = 10.0;
constexpr std::size_t kFewestFeatures = 20;
constexpr double kClear = 2.5;
/// From scan to scan; of scans farther apart SLAM registers few.
constexpr int kMostTurns = 10;
/// Least share by which scans fit better as ones of every second turn, if they are: 0.15 and more
/// on a real drive and simulated ones; those of every turn fit worse so.
constexpr double kLeastGain = 0.05;

struct ScanFit {
  double moved_m = 0.0;
  std::optional<double> distance_m;
};

/// Whether its scans are images, which are taken as rolling where nothing states it.
bool is_stack(const std::string& input) {
  return input.ends_with(".npy") || !file_of_drive(input, "scans.npy").empty();
}

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

struct Fits {
  std::vector<ScanFit> scans;
  bool has_stamps = false;  ///< of the recording
  bool is_of_kitti = false;
};

/// turns: of the sensor from scan to scan; 1: with the recording's stamps, if it has any.
Fits fits(const std::string& input, const SensorModel& sensor, recordings::OpenOptions options,
          CaptureTime capture_time, int turns = 1) {
  if (options.sensor.empty()) options.all_rows = sensor;
  options.files.capture = capture_time;
  const char* capture = capture_time == CaptureTime::kRolling ? "rolling" : "corrected";
  std::string tested = fmt::format("test of --capture {}", capture);
  if (turns > 1) {
    options.files.stamps = stamps_text(turns, sensor);
    tested += " --stamps " + options.files.stamps;
  }
  auto source = recordings::Recording::open(input, options);
  slam::Slam slam(source.sensor());
  LeftOut left_out;
  Fits result;
  result.has_stamps = source.has_stamps();
  Progress progress(tested, std::min(kMostTestedScans, source.size().value_or(kMostTestedScans)));
  while (std::ssize(result.scans) < kMostTestedScans) {
    const auto scan = next_usable(source, left_out);
    if (!scan) break;
    result.is_of_kitti = scan->name.ends_with(".bin");
    slam::ScanTrace trace;
    const Twist velocity = slam.process(scan->cloud, scan->stamp_s, &trace).velocity;
    const double speed_m_s = velocity.linear.norm() + kLever_m * velocity.angular.norm();
    result.scans.push_back({speed_m_s * sensor.scan_period_s * turns, median_distance_m(trace)});
    progress.update(std::ssize(result.scans));
  }
  progress.finish();
  return result;
}

/// Two fits of the same scans.
struct Comparison {
  int scans = 0;           ///< in which the sensor moved
  double first_m = 0.0;    ///< mean of the distances
  double second_m = 0.0;   ///< the same
  double log_ratio = 0.0;  ///< mean of log(first / second)
  bool is_clear = false;   ///< that it is not 0
};

Comparison compared(const Fits& first, const Fits& second) {
  Comparison result;
  double sum_of_squares = 0.0;
  for (std::size_t i = 0; i < std::min(first.scans.size(), second.scans.size()); ++i) {
    const ScanFit& one = first.scans[i];
    const ScanFit& other = second.scans[i];
    const bool is_moved = std::min(one.moved_m, other.moved_m) > kMoved_m;
    if (!is_moved || !one.distance_m || !other.distance_m) continue;
    const double log_ratio = std::log(*one.distance_m / *other.distance_m);
    result.log_ratio += log_ratio;
    sum_of_squares += log_ratio * log_ratio;
    result.first_m += *one.distance_m;
    result.second_m += *other.distance_m;
    ++result.scans;
  }
  if (result.scans == 0) return result;
  result.first_m /= result.scans;
  result.second_m /= result.scans;
  result.log_ratio /= result.scans;
  const double variance = sum_of_squares / result.scans - result.log_ratio * result.log_ratio;
  result.is_clear = result.scans >= kFewestTestedScans &&
                    std::abs(result.log_ratio) > kClear * std::sqrt(variance / result.scans);
  return result;
}

}  // namespace

std::string stamps_text(int turns, const SensorModel& sensor) {
  return fmt::format("{:g}", turns * sensor.scan_period_s);
}

CaptureCheck check_capture(const std::string& input, const SensorModel& sensor,
                           const recordings::OpenOptions& options) {
  Fits rolling = fits(input, sensor, options, CaptureTime::kRolling);
  const Fits corrected = fits(input, sensor, options, CaptureTime::kMotionCorrected);
  CaptureCheck check;
  check.is_of_kitti = rolling.is_of_kitti;
  Comparison of_both = compared(rolling, corrected);
  const bool may_lack_turns = options.files.stamps.empty() && !rolling.has_stamps &&
                              !rolling.is_of_kitti && of_both.scans > 0;
  for (int turns = 2; may_lack_turns && turns <= kMostTurns; ++turns) {
    Fits sparse = fits(input, sensor, options, CaptureTime::kRolling, turns);
    const Comparison gain = compared(sparse, rolling);
    const bool is_better = gain.is_clear && gain.log_ratio < (turns == 2 ? -kLeastGain : 0.0);
    const Comparison sparse_and_corrected = compared(sparse, corrected);
    // Corrected scans fit the better the less they are corrected again, but never better than so.
    if (!is_better || sparse_and_corrected.log_ratio > 0.0) break;
    rolling = std::move(sparse);
    of_both = sparse_and_corrected;
    check.turns = turns;
  }
  check.scans = of_both.scans;
  check.rolling_m = of_both.first_m;
  check.corrected_m = of_both.second_m;
  if (of_both.is_clear) {
    check.verdict = of_both.log_ratio < 0.0 ? CaptureTime::kRolling : CaptureTime::kMotionCorrected;
  }
  if (check.verdict != CaptureTime::kRolling) check.turns = 1;
  return check;
}

std::optional<CaptureCheck> check_clouds_without_times(const std::string& input,
                                                       const recordings::OpenOptions& options) {
  const bool can_be_read_twice =
      std::filesystem::is_regular_file(input) || std::filesystem::is_directory(input);
  if (!can_be_read_twice || is_stack(input) || options.files.capture) return std::nullopt;
  try {
    auto source = recordings::Recording::open(input, options);
    LeftOut left_out;
    const auto first = next_usable(source, left_out);
    const bool has_times = first && !first->cloud.time_offset_s.empty();
    if (!first || has_times || source.size() == 1 || source.sensor().motion_corrected) {
      return std::nullopt;
    }
    return check_capture(input, source.sensor(), options);
  } catch (const Error&) {
    return std::nullopt;  // whoever reads the recording reports it
  }
}

std::string fit_text(const CaptureCheck& check) {
  if (check.scans == 0) {
    return "too few scans moved to determine whether they are corrected for motion";
  }
  return fmt::format(
      "{} scans that moved fit each other within {:.1f} mm as captured while the sensor turned{}, "
      "within {:.1f} mm as corrected for motion{}",
      check.scans, 1e3 * check.rolling_m,
      check.turns > 1 ? fmt::format(", in one of {} turns", check.turns) : "",
      1e3 * check.corrected_m, check.verdict ? "" : ": the difference is too small to decide");
}

}  // namespace hqslam::tools

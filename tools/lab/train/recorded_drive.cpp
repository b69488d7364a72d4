#include "train/recorded_drive.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <utility>

#include "hqslam/core/error.h"
#include "hqslam/nn/scan_memory.h"
#include "hqslam/pipeline/drive_memory.h"
#include "hqslam/pipeline/pipeline.h"
#include "hqslam/slam/status.h"
#include "recording/reading.h"
#include "terminal/progress.h"

namespace hqslam::tools {
namespace {

/// The scans before and after a scan that are the reference between its rows: 4 s of a sensor with
/// ten turns a second. Further ones saw most surfaces from too far away.
constexpr std::int64_t kScansAround = 40;
constexpr nn::ScanMemoryOptions kReferenceScans = {
    .scans = 2 * kScansAround + 1, .path_m = 80.0, .time_s = 20.0};
/// W^2 from which a recalled range is the truth: as much as one point through a pixel's centre.
constexpr float kLeastWeight = 4.0F;
/// Twice a sensor's noise and the errors of poses that SLAM registered.
constexpr float kSameRange_m = 0.06F;
/// Training keeps them all in memory, at 0.5 MB each.
constexpr std::int64_t kMostScans = 3000;

struct LocatedScans {
  std::vector<OrganizedCloud> measured;
  std::vector<double> stamp_s;
  pipeline::ScanPoses poses;
};

/// Poses of different segments are in no common frame.
void keep_largest_segment(const std::vector<std::size_t>& segment_of_scan,
                          std::vector<bool>& is_located) {
  std::map<std::size_t, int> scans;
  for (const std::size_t segment : segment_of_scan) ++scans[segment];
  const auto largest =
      std::ranges::max_element(scans, {}, [](const auto& segment) { return segment.second; });
  for (std::size_t i = 0; i < is_located.size(); ++i) {
    if (segment_of_scan[i] != largest->first) is_located[i] = false;
  }
}

LocatedScans located_scans(pipeline::UpsampledRecording& opened, const InterruptGuard& interrupt) {
  LocatedScans located;
  pipeline::Pipeline slam(opened.upsampler.measured_sensor());
  Progress progress("SLAM", opened.recording.size());
  Reading reading;
  read_scans(opened.recording, interrupt, reading, [&](const ReadScan& read) {
    OrganizedCloud measured = opened.upsampler.measured(read.scan.cloud);
    const slam::ScanReport report = slam.process(measured, read.scan.stamp_s).report;
    located.poses.is_located.push_back(slam::is_registered(report.mapping_status));
    located.stamp_s.push_back(read.scan.stamp_s);
    located.measured.push_back(std::move(measured));
    progress.advance();
    return std::ssize(located.measured) < kMostScans;
  });
  progress.finish();
  if (reading.end == ReadingEnd::kUnreadableScan) throw Error(reading.end_message);
  if (reading.end == ReadingEnd::kInterrupted) return {};
  slam.finish();
  located.poses.trajectory = slam.trajectory();
  keep_largest_segment(slam.segment_of_scan(), located.poses.is_located);
  return located;
}

/// In a measured row: whether other scans measured the same range as this one, another one, or
/// nothing.
enum class Agreement { kSame, kOther, kUnknown };
Agreement agreement(float measured_m, float recalled_m) {
  if (measured_m <= 0.0F || recalled_m <= 0.0F) return Agreement::kUnknown;
  const bool is_same = std::fabs(measured_m - recalled_m) <= kSameRange_m;
  return is_same ? Agreement::kSame : Agreement::kOther;
}

/// Minus the ranges that others measured in computed rows, in measured rows what was measured. What
/// others measured counts where it agrees with this scan's own rows above and below: elsewhere
/// something has moved, or a pose is off.
nn::TrainingScan scan_with_truth(const RangeImage& measured, const nn::RecalledImage& recalled,
                                 RowSelection rows) {
  nn::TrainingScan scan{recalled.image};
  const auto agrees = [&](int beam, int column) {
    const int clamped = std::clamp(beam, 0, measured.rows - 1);
    return agreement(measured.at(clamped, column),
                     recalled.image.at(rows.offset + clamped * rows.stride, column));
  };
  for (int row = 0; row < scan.truth.rows; ++row) {
    const int below = (row - rows.offset + rows.stride - 1) / rows.stride;
    for (int column = 0; column < scan.truth.columns; ++column) {
      float& truth_m = scan.truth.at(row, column);
      if (rows.contains(row)) {
        truth_m = measured.at((row - rows.offset) / rows.stride, column);
      } else {
        const Agreement up = agrees(below - 1, column);
        const Agreement down = agrees(below, column);
        const bool is_confirmed = up != Agreement::kOther && down != Agreement::kOther &&
                                  (up == Agreement::kSame || down == Agreement::kSame);
        const bool is_known =
            is_confirmed && recalled.weight[recalled.image.index(row, column)] >= kLeastWeight;
        truth_m = is_known && truth_m > 0.0F ? -truth_m : nn::kUnknownTruth_m;
      }
    }
  }
  return scan;
}

}  // namespace

RecordedDrive read_recorded_drive(const InputChoice& input, const std::string& weights,
                                  const InterruptGuard& interrupt) {
  pipeline::UpsampledRecording opened =
      pipeline::open_upsampled(input.input, open_options(input), {.method = weights});
  const pipeline::Upsampler& upsampler = opened.upsampler;
  const LocatedScans located = located_scans(opened, interrupt);
  const SensorModel& sensor = upsampler.sensor();
  RecordedDrive drive{{}, sensor, *sensor.measured_rows};
  nn::ScanMemory memory(sensor, kReferenceScans);
  const auto count = std::ssize(located.measured);
  const auto poses_of = [&](std::int64_t i) -> std::optional<nn::ColumnPoses> {
    const auto path = located.poses.path_of(i, located.stamp_s[i], sensor.scan_period_s);
    if (!path) return std::nullopt;
    return pipeline::column_poses(*path, located.measured[i], sensor);
  };
  Progress progress("what other scans measured", count);
  for (std::int64_t next = 0, i = 0; i < count && !interrupt.stop_requested(); ++i) {
    for (; next <= std::min(i + kScansAround, count - 1); ++next) {
      if (const auto poses = poses_of(next)) {
        memory.insert(located.measured[next], *poses, located.stamp_s[next]);
      }
    }
    progress.advance();
    const auto poses = poses_of(i);
    if (!poses) continue;
    const RangeImage measured = range_image(located.measured[i]);
    const nn::RecalledImage recalled = memory.recall(measured, *poses, located.stamp_s[i]);
    if (recalled.is_empty()) continue;
    drive.scans.push_back(scan_with_truth(measured, recalled, drive.measured_rows));
  }
  progress.finish();
  return interrupt.stop_requested() ? RecordedDrive{} : drive;
}

}  // namespace hqslam::tools

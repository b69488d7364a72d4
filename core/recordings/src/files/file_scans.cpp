#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

#include "files/scan_files.h"
#include "hqslam/core/error.h"
#include "hqslam/core/point_fields.h"
#include "points/azimuth_times.h"
#include "points/recorded_scan.h"
#include "points/ring_numbers.h"
#include "points/sensor_finder.h"
#include "points/thinned_clouds.h"
#include "points/time_check.h"

namespace hqslam::recordings {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kScansToTry = 10;
constexpr std::size_t kScansToLearnFrom = 5;

class FileScanSource : public ScanSource {
 public:
  FileScanSource(std::vector<std::string> paths, const ChooseSensor& choose,
                 const RecordingOptions& options)
      : paths_(std::move(paths)), capture_(options.capture) {
    read_stamps(options.stamps);
    // Seconds that the user gave are those of several turns.
    const bool are_of_turns = !stamp_spacing_s(options.stamps);
    const std::vector<double> stamps_of_turns_s = are_of_turns ? stamps_s_ : std::vector<double>();
    FoundSensor chosen = choose([&] { return find_sensor_of_files(paths_, stamps_of_turns_s); });
    sensor_ = std::move(chosen.sensor);
    validate(sensor_);
    if (!chosen.note.empty()) {
      warnings_.push_back(fmt::format("{}: {}", paths_.front(), chosen.note));
    }
    if (auto own = with_own_beams(sensor_, chosen.beam_elevation_rad); own && !chosen.is_found) {
      warnings_.push_back(fmt::format(
          "{}: the beams are off the table of sensor '{}'; read with those of this unit, from its "
          "first scans",
          paths_.front(), sensor_.name));
      sensor_ = std::move(*own);
    }
    azimuth_times_ = AzimuthTimes(sensor_.scan_period_s);
    look_at_first_scans();
    fit_columns_to_first();
  }

  const SensorModel& sensor() const override { return sensor_; }
  std::optional<std::int64_t> size() const override { return std::ssize(paths_); }
  double read_share() const override {
    return static_cast<double>(next_) / static_cast<double>(paths_.size());
  }
  bool has_stamps() const override { return has_stamps_; }
  std::vector<std::string> warnings() const override { return warnings_; }

  std::optional<RecordedScan> next() override {
    if (next_ == paths_.size()) return std::nullopt;
    const std::size_t index = next_++;
    try {
      RecordedScan result = recorded(index);
      if (!std::exchange(any_used_, true) && !is_thinned_) {
        if (std::string text = fit_warning(result, sensor_); !text.empty()) {
          warnings_.push_back(std::move(text));
        }
      }
      return result;
    } catch (const Error& error) {
      // One scan may be damaged; if the first ones all are, the recording is not what it should be.
      if (!any_used_ && index + 1 >= std::min(kScansToTry, paths_.size())) throw;
      throw ScanError(error.what());
    }
  }

 private:
  /// The stamps that are asked for, or those of KITTI's timestamps.txt.
  void read_stamps(const std::string& wanted) {
    std::string path = wanted;
    if (wanted == kStampsFromNames) {
      stamps_s_ = stamps_from_names_s(paths_);
      return;
    }
    if (const auto spacing_s = stamp_spacing_s(wanted)) {
      for (std::size_t i = 0; i < paths_.size(); ++i) {
        stamps_s_.push_back(static_cast<double>(i) * *spacing_s);
      }
      return;
    }
    const fs::path folder = fs::path(paths_.front()).parent_path();
    for (const fs::path& above : {folder, folder.parent_path()}) {
      std::error_code error;
      const fs::path usual = above / "timestamps.txt";
      if (path.empty() && paths_.size() > 1 && fs::is_regular_file(usual, error)) {
        path = usual.string();
      }
    }
    if (path.empty()) return;
    stamps_s_ = read_stamps_s(path);
    if (stamps_s_.size() != paths_.size()) {
      throw Error(
          "{}: expected a stamp for each of {} scans, found {}; give a file with as many lines",
          path, paths_.size(), stamps_s_.size());
    }
  }

  /// Reads the first scans, whose points are kept until their turn.
  void look_at_first_scans() {
    std::vector<PointTimeField> times;
    std::vector<RawPoints> with_rings;
    for (std::size_t i = 0; i < std::min(kScansToLearnFrom, paths_.size()); ++i) {
      try {
        first_points_[i] = read_point_file(paths_[i]);
      } catch (const Error&) {
        continue;  // reported when its turn comes
      }
      times.push_back(first_points_[i]->time);
      if (!first_points_[i]->ring.empty()) with_rings.push_back(*first_points_[i]);
    }
    has_clock_ = times_rise(times, sensor_.scan_period_s);
    has_stamps_ = !stamps_s_.empty() || std::ranges::any_of(times, [&](PointTimeField field) {
      field.is_of_clock = has_clock_;
      const auto found = usable_times(field, sensor_.scan_period_s);
      return found && found->absolute;
    });
    ring_numbers_ = ring_numbers(with_rings, sensor_);
    if (!has_stamps_) count_missing_scans();
  }

  void count_missing_scans() {
    numbers_ = numbers_with_gaps(paths_);
    if (numbers_.empty()) return;
    warnings_.push_back(fmt::format(
        "{}: files are numbered {} to {}, and {} of these numbers are missing: {} s are counted "
        "for each; --stamps gives other stamps",
        paths_.front(), numbers_.front(), numbers_.back(),
        numbers_.back() - numbers_.front() + 1 - numbers_.size(), sensor_.scan_period_s));
  }

  /// How many periods after the first scan this one was captured, without stamps.
  std::size_t periods_at(std::size_t index) const {
    return numbers_.empty() ? index : numbers_[index] - numbers_.front();
  }

  void fit_columns_to_first() {
    const std::optional<RawPoints> first = first_points_[0];
    if (!first) return;
    const std::string& path = paths_.front();
    try {
      std::string text = fit_columns(recorded_scan(scan_at(0), sensor_, path).cloud, path, sensor_);
      is_thinned_ = !text.empty();
      if (is_thinned_) warnings_.push_back(std::move(text));
    } catch (const Error&) {
      // Reported when its turn comes.
    }
    first_points_[0] = first;
  }

  RawPoints points_of(std::size_t index) {
    const bool is_kept = index < first_points_.size() && first_points_[index].has_value();
    RawPoints points = is_kept ? std::move(*first_points_[index]) : read_point_file(paths_[index]);
    if (is_kept) first_points_[index].reset();
    ring_numbers_.count_from_0(points.ring);
    points.time.is_of_clock = has_clock_;
    return points;
  }

  Scan scan_at(std::size_t index) {
    const std::string& path = paths_[index];
    Scan scan = scan_of(points_of(index), &sensor_, path);
    // A .pcd file is a driver's, with rings where they are known; else elevations determine rows.
    if (!path.ends_with(".pcd")) set_rows_by_order(scan, sensor_, path);
    return scan;
  }

  RecordedScan recorded(std::size_t index) {
    const std::string& path = paths_[index];
    Scan scan = scan_at(index);
    if (capture_ == CaptureTime::kMotionCorrected) scan.time_offset_s.clear();
    if (const std::string text = time_check_.check(scan, sensor_.scan_period_s); !text.empty()) {
      warnings_.push_back(fmt::format("{}: {}", path, text));
    }
    const bool has_times = !scan.time_offset_s.empty();
    if (!has_times && capture_ == CaptureTime::kRolling) {
      const double clock_s = scan.stamp_s;  // remains
      azimuth_times_.set(scan, sensor_, periods_at(index));
      if (clock_s != 0.0) scan.stamp_s = clock_s;
    }
    if (!stamps_s_.empty()) {
      scan.stamp_s = stamps_s_[index];
    } else if (scan.stamp_s == 0.0) {
      scan.stamp_s = static_cast<double>(periods_at(index)) * sensor_.scan_period_s;
    }
    RecordedScan result = recorded_scan(scan, sensor_, path);
    if (!has_times && !capture_) warn_of_missing_times();
    return result;
  }

  /// Once, and not of a single scan, which fits nothing else.
  void warn_of_missing_times() {
    if (std::exchange(is_warned_, true) || paths_.size() == 1) return;
    warnings_.push_back(
        fmt::format("{}: points without times are taken as corrected for motion; {}",
                    paths_.front(), kTestedByInfo));
  }

  std::vector<std::string> paths_;
  SensorModel sensor_;
  std::vector<double> stamps_s_;
  std::vector<std::size_t> numbers_;  ///< of the files, if some are missing
  std::vector<std::string> warnings_;
  std::optional<CaptureTime> capture_;
  TimeCheck time_check_;
  AzimuthTimes azimuth_times_{0.0};
  std::array<std::optional<RawPoints>, kScansToLearnFrom> first_points_;
  RingNumbers ring_numbers_;
  bool has_stamps_ = false;
  bool has_clock_ = false;  ///< times of points are those of a clock
  std::size_t next_ = 0;
  bool any_used_ = false;
  bool is_warned_ = false;
  bool is_thinned_ = false;
};

}  // namespace

std::unique_ptr<ScanSource> make_file_scan_source(std::vector<std::string> paths,
                                                  const ChooseSensor& choose,
                                                  const RecordingOptions& options) {
  return std::make_unique<FileScanSource>(std::move(paths), choose, options);
}

}  // namespace hqslam::recordings

#include "file_scan_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <utility>

#include "azimuth_times.h"
#include "hqslam/core/error.h"
#include "hqslam/core/kitti_bin.h"
#include "hqslam/core/recorded_scan.h"
#include "own_elevations.h"
#include "point_files.h"
#include "scan_stamps.h"

namespace hqslam {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kScansToTry = 10;
constexpr std::size_t kScansToLearnFrom = 5;

RawPoints read_points(const std::string& path) {
  if (path.ends_with(".pcd")) return read_pcd_points(path);
  if (path.ends_with(".ply")) return read_ply_points(path);
  if (path.ends_with(".bin")) return RawPoints(read_kitti_bin(path));
  return read_text_points(path);
}

class FileScanSource : public ScanSource {
 public:
  FileScanSource(std::vector<std::string> paths, SensorModel sensor,
                 const RecordingOptions& options)
      : paths_(std::move(paths)),
        sensor_(std::move(sensor)),
        times_from_azimuth_(options.times_from_azimuth),
        azimuth_times_(sensor_.scan_period_s) {
    read_stamps(options.stamps);
    look_at_first_scans();
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
      any_used_ = true;
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
          fmt::format("{}: expected a stamp for each of {} scans, found {}; give a file with "
                      "as many lines",
                      path, paths_.size(), stamps_s_.size()));
    }
  }

  /// Looks at the first scans, whose points are kept until it is their turn.
  void look_at_first_scans() {
    has_stamps_ = !stamps_s_.empty();
    std::vector<Scan> scans;
    for (std::size_t i = 0; i < std::min(kScansToLearnFrom, paths_.size()); ++i) {
      try {
        first_points_[i] = read_points(paths_[i]);
        scans.push_back(scan_of(*first_points_[i], &sensor_, paths_[i]));
        has_stamps_ = has_stamps_ || scans.back().stamp_s != 0.0;
        set_rows(scans.back(), paths_[i], false);
      } catch (const Error&) {
        continue;  // will be said when it is its turn
      }
    }
    if (auto own = with_own_elevations(sensor_, scans)) {
      warnings_.push_back(fmt::format(
          "{}: the beams are off the table of sensor '{}'; read with those of this unit, from its "
          "first scans",
          paths_.front(), sensor_.name));
      sensor_ = std::move(*own);
    }
  }

  /// A .pcd file is what a driver gives, which would have said the rings; its elevations tell.
  void set_rows(Scan& scan, const std::string& path, bool must_fit) const {
    if (!path.ends_with(".pcd")) set_rows_by_order(scan, sensor_, path, must_fit);
  }

  RawPoints points_of(std::size_t index) {
    if (index >= first_points_.size() || !first_points_[index]) return read_points(paths_[index]);
    RawPoints points = std::move(*first_points_[index]);
    first_points_[index].reset();
    return points;
  }

  RecordedScan recorded(std::size_t index) {
    const std::string& path = paths_[index];
    Scan scan = scan_of(points_of(index), &sensor_, path);
    set_rows(scan, path, true);
    if (times_from_azimuth_ && scan.time_offset_s.empty()) {
      azimuth_times_.set(scan, sensor_, index);
    }
    if (!stamps_s_.empty()) {
      scan.stamp_s = stamps_s_[index];
    } else if (scan.stamp_s == 0.0) {
      scan.stamp_s = static_cast<double>(index) * sensor_.scan_period_s;
    }
    return recorded_scan(scan, sensor_, path);
  }

  std::vector<std::string> paths_;
  SensorModel sensor_;
  std::vector<double> stamps_s_;
  std::vector<std::string> warnings_;
  bool times_from_azimuth_;
  AzimuthTimes azimuth_times_;
  std::array<std::optional<RawPoints>, kScansToLearnFrom> first_points_;
  bool has_stamps_ = false;
  std::size_t next_ = 0;
  bool any_used_ = false;
};

}  // namespace

std::unique_ptr<ScanSource> make_file_scan_source(std::vector<std::string> paths,
                                                  const SensorModel& sensor,
                                                  const RecordingOptions& options) {
  return std::make_unique<FileScanSource>(std::move(paths), sensor, options);
}

}  // namespace hqslam

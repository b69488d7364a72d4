#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <utility>

#include "files/scan_files.h"
#include "hqslam/core/error.h"
#include "hqslam/core/excerpt.h"
#include "hqslam/core/npy.h"
#include "hqslam/core/whole_file.h"
#include "hqslam/core/words.h"
#include "points/recorded_scan.h"
#include "points/ring_numbers.h"

namespace hqslam::recordings {

namespace {

constexpr std::int64_t kImagesToTry = 10;

/// A column on each line: where the turn of each image begins, which `hqslam upsample` writes for
/// sensors that begin anywhere.
std::vector<int> read_first_columns(const std::string& path, int columns) {
  constexpr std::size_t kMostBytes = 64U << 20U;
  const std::string file = whole_file(path, "a file of columns", kMostBytes);
  std::vector<int> first;
  for (std::string_view rest = file; !rest.empty();) {
    const std::string_view line = next_line(rest);
    const auto column = number_from<int>(line);
    if (!column || *column < 0 || *column >= columns) {
      throw Error(
          "{}: line {}: expected a column from 0 to {}, found '{}'; upsample the recording again",
          path, first.size() + 1, columns - 1, excerpt(line));
    }
    first.push_back(*column);
  }
  return first;
}

void flip_rows(RangeImage& image) {
  for (int row = 0; row < image.rows / 2; ++row) {
    const auto top = image.range_m.begin() + static_cast<std::ptrdiff_t>(image.index(row, 0));
    const auto bottom =
        image.range_m.begin() + static_cast<std::ptrdiff_t>(image.index(image.rows - 1 - row, 0));
    std::swap_ranges(top, top + image.columns, bottom);
  }
}

class ImageStackSource : public ScanSource {
 public:
  ImageStackSource(const std::string& path, const SensorModel& sensor,
                   const RecordingOptions& options, std::vector<double> stamps_s, bool of_folder)
      : path_(path),
        sensor_(sensor),
        row_order_(options.row_order),
        capture_time_(options.capture.value_or(
            sensor.motion_corrected ? CaptureTime::kMotionCorrected : CaptureTime::kRolling)),
        stamps_s_(std::move(stamps_s)),
        spacing_s_(stamp_spacing_s(options.stamps).value_or(sensor.scan_period_s)),
        reader_(path) {
    if (reader_.rows() != sensor.rows() || reader_.columns() != sensor.columns) {
      throw Error(
          "{}: expected images of {} x {} pixels (sensor '{}'), found {} x {}; name the sensor "
          "that recorded them",
          path, sensor.rows(), sensor.columns, sensor.name, reader_.rows(), reader_.columns());
    }
    if (reader_.images() == 0) {
      throw Error("{}: expected at least one image, found none; record again", path);
    }
    complete_stamps(!options.stamps.empty());
    leave_out_empty_rows();
    if (!of_folder) return;
    confidence_ = beside("confidence.npy", false);
    intensity_ = beside("intensity.npy", true);
    const auto columns = std::filesystem::path(path).replace_filename("first_columns.txt");
    std::error_code error;
    if (!std::filesystem::exists(columns, error)) return;
    first_columns_ = read_first_columns(columns.string(), sensor.columns);
    if (std::ssize(first_columns_) < reader_.images()) {
      throw Error(
          "{}: expected a line for each of {} images, found {}; upsample the recording again",
          columns.string(), reader_.images(), first_columns_.size());
    }
  }

  const SensorModel& sensor() const override { return sensor_; }
  std::optional<std::int64_t> size() const override { return reader_.images(); }
  double read_share() const override {
    return static_cast<double>(next_) / static_cast<double>(reader_.images());
  }
  bool has_stamps() const override { return !stamps_s_.empty(); }
  std::vector<std::string> warnings() const override {
    std::vector<std::string> warnings;
    if (!note_.empty()) warnings.push_back(note_);
    if (too_far_ == 0) return warnings;
    warnings.push_back(
        fmt::format("{}: {} pixels hold ranges beyond the {} m of sensor '{}': taken as no return",
                    path_, too_far_, sensor_.max_range_m, sensor_.name));
    return warnings;
  }

  std::optional<RecordedScan> next() override {
    if (next_ == reader_.images()) return std::nullopt;
    const std::int64_t index = next_++;
    RecordedScan result;
    result.name = fmt::format("{}[{}]", path_, index);
    result.stamp_s = stamps_s_.empty() ? static_cast<double>(index) * spacing_s_
                                       : stamps_s_[static_cast<std::size_t>(index)];
    RangeImage image = image_of(reader_, index);
    const std::int64_t foreign = remove_bad_pixels(image, result);
    require_ranges_of_sensor(result, foreign, index);
    any_used_ = true;
    const int first = first_columns_.empty() ? 0 : first_columns_[static_cast<std::size_t>(index)];
    result.cloud = unproject(image, sensor_, capture_time_, first);
    if (intensity_) result.cloud.intensity = values_of(*intensity_, image, index);
    if (!confidence_) return result;
    result.cloud.confidence = values_of(*confidence_, image, index);
    for (float& value : result.cloud.confidence) {
      value = value >= 0.0F ? std::min(value, 1.0F) : 0.0F;
    }
    return result;
  }

 private:
  /// The file with further values of each pixel, if there is one of this name beside the stack.
  std::optional<NpyStackReader> beside(const char* name, bool or_bytes) const {
    const auto path = std::filesystem::path(path_).replace_filename(name);
    std::error_code error;
    if (!std::filesystem::exists(path, error)) return std::nullopt;
    NpyStackReader values(path.string(), or_bytes);
    if (values.rows() != reader_.rows() || values.columns() != reader_.columns() ||
        values.images() < reader_.images()) {
      throw Error(
          "{}: expected a value for each pixel of {} images of {} x {}, found {} of {} x {}; make "
          "the recording again, or take the file away",
          path.string(), reader_.images(), reader_.rows(), reader_.columns(), values.images(),
          values.rows(), values.columns());
    }
    return values;
  }

  /// The values of an image's pixels; 0 where there is no return.
  std::vector<float> values_of(NpyStackReader& stack, const RangeImage& image, std::int64_t index) {
    RangeImage values = image_of(stack, index);
    for (std::size_t i = 0; i < values.range_m.size(); ++i) {
      if (image.range_m[i] <= 0.0F) values.range_m[i] = 0.0F;
    }
    return std::move(values.range_m);
  }

  RangeImage image_of(NpyStackReader& stack, std::int64_t index) const {
    RangeImage image = stack.read(index);
    if (row_order_ == RowOrder::kLowestFirst) flip_rows(image);
    return filled_ ? select_rows(image, *filled_) : image;
  }

  /// Where beams were deleted, or the sensor has fewer than its images have rows.
  void leave_out_empty_rows() {
    if (sensor_.measured_rows) return;  // computed rows may be empty
    constexpr std::int64_t kImages = 5;
    std::set<int> rows;
    for (std::int64_t i = 0; i < std::min(kImages, reader_.images()); ++i) {
      const RangeImage image = image_of(reader_, i);
      for (int row = 0; row < image.rows; ++row) {
        const auto begin = image.range_m.begin() + row * image.columns;
        if (std::any_of(begin, begin + image.columns, [](float r) { return r > 0.0F; })) {
          rows.insert(row);
        }
      }
    }
    filled_ = selection_of({rows.begin(), rows.end()});
    if (!filled_) return note_holes(rows);
    note_ = fmt::format("{}: {}", path_, selection_text(sensor_.rows(), *filled_));
    sensor_ = select_rows(sensor_, *filled_);
  }

  /// Rows without a return between others that have some, where they are a quarter of these or
  /// more: SLAM misses them, and no even choice of rows does without.
  void note_holes(const std::set<int>& filled) {
    if (filled.empty()) return;
    const int between = *filled.rbegin() - *filled.begin() + 1;
    const int holes = between - static_cast<int>(filled.size());
    if (4 * holes < between) return;
    note_ = fmt::format("{}: {} of the {} rows {} to {} hold nothing; give images of the others",
                        path_, holes, between, *filled.begin(), *filled.rbegin());
  }

  /// The folder may hold more stamps than images where upsampling was interrupted, and one fewer
  /// where simulation was, between a scan and its truth. Stamps that the user asked for must be as
  /// many as the images.
  void complete_stamps(bool asked_for) {
    if (stamps_s_.empty()) return;
    const auto images = static_cast<std::size_t>(reader_.images());
    if (!asked_for && stamps_s_.size() + 1 == images) {
      stamps_s_.push_back(stamps_s_.back() + sensor_.scan_period_s);
    }
    if (stamps_s_.size() < images || (asked_for && stamps_s_.size() > images)) {
      throw Error(
          "{}: expected a stamp for each of {} images, found {}; give a file with as many lines, "
          "or in a folder the timestamps.txt or truth.tum of this recording",
          path_, images, stamps_s_.size());
    }
  }

  /// Returns the number of pixels that cannot be in metres: not finite, negative or too far, and
  /// those that are too near if none is left. A cover or a dock may be too near for most of a scan.
  std::int64_t remove_bad_pixels(RangeImage& image, RecordedScan& result) {
    std::int64_t foreign = 0;
    for (float& range_m : image.range_m) {
      if (range_m == 0.0F) continue;
      if (!std::isfinite(range_m) || range_m < 0.0F) {
        ++result.invalid_points;
        ++foreign;
        range_m = 0.0F;
      } else if (range_m < sensor_.min_range_m || range_m > sensor_.max_range_m) {
        ++result.counts.out_of_range;
        const bool is_too_far = range_m > sensor_.max_range_m;
        too_far_ += is_too_far ? 1 : 0;
        foreign += is_too_far ? 1 : 0;
        range_m = 0.0F;
      } else {
        ++result.counts.kept;
      }
    }
    return result.counts.kept > 0 ? foreign : result.counts.out_of_range + result.invalid_points;
  }

  /// One image may be damaged; if the first ones all are, the stack is not what it should be.
  void require_ranges_of_sensor(const RecordedScan& scan, std::int64_t foreign,
                                std::int64_t index) const {
    const double share =
        static_cast<double>(foreign) / static_cast<double>(sensor_.rows() * sensor_.columns);
    if (share <= kMaxForeignShare) return;
    const std::string error = fmt::format(
        "{}: expected ranges from {} to {} m (sensor '{}') and 0 for no "
        "return, found {:.0f} % of the pixels outside; give ranges in metres",
        scan.name, sensor_.min_range_m, sensor_.max_range_m, sensor_.name, 100.0 * share);
    if (!any_used_ && index + 1 >= std::min(kImagesToTry, reader_.images())) throw Error(error);
    throw ScanError(error);
  }

  std::string path_;
  SensorModel sensor_;
  RowOrder row_order_;
  CaptureTime capture_time_;
  std::vector<double> stamps_s_;
  double spacing_s_;                    ///< without these
  std::optional<RowSelection> filled_;  ///< the rows that hold anything; nothing: all
  std::string note_;
  std::vector<int> first_columns_;  ///< empty: all begin at 0
  NpyStackReader reader_;
  std::optional<NpyStackReader> confidence_;
  std::optional<NpyStackReader> intensity_;
  std::int64_t next_ = 0;
  bool any_used_ = false;
  std::int64_t too_far_ = 0;  ///< pixels of the images that were read
};

}  // namespace

std::unique_ptr<ScanSource> make_image_stack_source(const std::string& path,
                                                    const SensorModel& sensor,
                                                    const RecordingOptions& options,
                                                    std::vector<double> stamps_s, bool of_folder) {
  return std::make_unique<ImageStackSource>(path, sensor, options, std::move(stamps_s), of_folder);
}

}  // namespace hqslam::recordings

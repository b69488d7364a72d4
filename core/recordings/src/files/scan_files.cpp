#include "files/scan_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <utility>

#include "hqslam/core/error.h"
#include "hqslam/core/point_fields.h"
#include "hqslam/core/trajectory.h"
#include "hqslam/core/words.h"
#include "wrapped_source.h"

namespace hqslam::recordings {

namespace {

namespace fs = std::filesystem;

constexpr const char* kKnownRecordings =
    "a capture (.pcap, .pcapng) or bag (.db3, .mcap, .bag) of a sensor, a folder of .bin, .pcd, "
    ".ply, .txt or .csv files, one such file, an .npy stack of range images or a folder "
    "written by 'hqslam-lab simulate'";

/// KITTI's file of stamps, and no scan.
bool is_timestamps(const std::string& path) {
  return fs::path(path).filename() == "timestamps.txt";
}

/// Files of a folder with this extension, in natural order. A link that leads nowhere keeps its
/// place: reading it fails in its turn, and the files behind it keep their stamps.
std::vector<std::string> files_in(const fs::path& folder, const std::string& extension) {
  std::vector<std::string> paths;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    std::error_code ignored;
    if (entry->path().extension() == extension && !entry->is_directory(ignored)) {
      paths.push_back(entry->path().string());
    }
  }
  if (error) {
    throw Error("{}: expected a folder that can be read, found '{}'; check its permissions",
                folder.string(), error.message());
  }
  std::ranges::sort(paths, naturally_before);
  return paths;
}

bool nearly_equal(const std::vector<double>& a, const std::vector<double>& b) {
  constexpr double kTolerance_rad = 1e-7;
  return std::ranges::equal(a, b,
                            [](double x, double y) { return std::abs(x - y) < kTolerance_rad; });
}

/// The images of such a folder are those of one sensor; with another one every point would be
/// displaced. Its sensor.json determines which rows were measured and whether they are corrected
/// for motion, for any sensor that the caller names.
SensorModel sensor_of_folder(const fs::path& folder, const std::optional<SensorModel>& named) {
  const std::string path = (folder / "sensor.json").string();
  const SensorModel recorded = read_sensor_json(path);
  const SensorModel& sensor = named ? *named : recorded;
  constexpr double kTolerance_s = 1e-9;
  const bool same = recorded.columns == sensor.columns &&
                    std::abs(recorded.scan_period_s - sensor.scan_period_s) < kTolerance_s &&
                    nearly_equal(recorded.beam_elevation_rad, sensor.beam_elevation_rad) &&
                    nearly_equal(recorded.beam_azimuth_offset_rad, sensor.beam_azimuth_offset_rad);
  if (!same) {
    throw Error(
        "{}: expected a drive of sensor '{}' ({} rows, {} columns, {} s a scan), found one of '{}' "
        "({} rows, {} columns, {} s a scan); name {} as the sensor",
        folder.string(), sensor.name, sensor.rows(), sensor.columns, sensor.scan_period_s,
        recorded.name, recorded.rows(), recorded.columns, recorded.scan_period_s, path);
  }
  SensorModel result = sensor;
  result.measured_rows = recorded.measured_rows;
  result.motion_corrected = recorded.motion_corrected;
  return result;
}

/// The stamps of a stack's images that are asked for; empty if none are, or evenly spaced ones.
std::vector<double> wanted_stamps_s(const std::string& stack, const RecordingOptions& options) {
  if (options.stamps.empty() || stamp_spacing_s(options.stamps)) return {};
  if (options.stamps == kStampsFromNames) {
    throw Error(
        "{}: expected files with numbers in their names to take stamps from, found a stack of "
        "images; give a file with a stamp per image",
        stack);
  }
  return read_stamps_s(options.stamps);
}

/// The same, or those in the folder of a stack: the ones that hqslam upsample copied, or those of
/// a simulated drive's truth.
std::vector<double> stamps_of_folder_s(const fs::path& folder, const RecordingOptions& options) {
  if (!options.stamps.empty()) return wanted_stamps_s(folder.string(), options);
  std::error_code error;
  if (const fs::path given = folder / "timestamps.txt"; fs::is_regular_file(given, error)) {
    return read_stamps_s(given.string());
  }
  std::vector<double> stamps_s;
  if (const fs::path truth = folder / "truth.tum"; fs::is_regular_file(truth, error)) {
    for (const StampedPose& pose : read_tum(truth.string())) stamps_s.push_back(pose.stamp_s);
  }
  return stamps_s;
}

[[noreturn]] void fail_for_folder_without_scans(const fs::path& folder) {
  const std::vector<std::string> stacks = files_in(folder, ".npy");
  if (!stacks.empty()) {
    throw Error(
        "{}: expected .bin or .pcd files, found .npy files; give the path of one of them, such as "
        "{}",
        folder.string(), stacks.front());
  }
  std::error_code error;
  throw Error("{}: expected .bin or .pcd files, found {}; give {}", folder.string(),
              fs::is_empty(folder, error) ? "an empty folder" : "none", kKnownRecordings);
}

/// The files of a folder with one of these extensions; empty if there are none. Throws Error if
/// there are some with different ones.
template <std::size_t N>
std::vector<std::string> files_of_one_kind(const fs::path& folder,
                                           const std::array<const char*, N>& extensions) {
  std::vector<std::string> paths;
  const char* kind = "";
  for (const char* extension : extensions) {
    std::vector<std::string> found = files_in(folder, extension);
    std::erase_if(found, is_timestamps);
    if (found.empty()) continue;
    if (!paths.empty()) {
      throw Error(
          "{}: expected files of one kind, found {} {} and {} {}; give a folder with one kind only",
          folder.string(), paths.size(), kind, found.size(), extension);
    }
    kind = extension;
    paths = std::move(found);
  }
  return paths;
}

std::unique_ptr<ScanSource> open_folder(const fs::path& folder,
                                        const std::optional<SensorModel>& sensor,
                                        const ChooseSensor& choose,
                                        const RecordingOptions& options) {
  std::error_code error;
  if (fs::exists(folder / "scans.npy", error) && fs::exists(folder / "sensor.json", error)) {
    return make_image_stack_source((folder / "scans.npy").string(),
                                   sensor_of_folder(folder, sensor), options,
                                   stamps_of_folder_s(folder, options), true);
  }
  std::vector<std::string> paths = files_of_one_kind(folder, kBinaryPoints);
  if (!paths.empty()) return make_file_scan_source(std::move(paths), choose, options);
  // KITTI keeps the scans of a drive in folders of these names.
  for (const char* below : {"velodyne", "velodyne_points/data"}) {
    if (fs::is_directory(folder / below, error))
      return open_folder(folder / below, sensor, choose, options);
  }
  // Last, because there are texts beside recordings of every kind.
  if (files_in(folder, ".npy").empty()) paths = files_of_one_kind(folder, kTextPoints);
  if (!paths.empty()) return make_file_scan_source(std::move(paths), choose, options);
  fail_for_folder_without_scans(folder);
}

class SourceWithImu : public WrappedSource {
 public:
  SourceWithImu(std::unique_ptr<ScanSource> source, std::vector<ImuSample> samples,
                std::string name)
      : WrappedSource(std::move(source)), samples_(std::move(samples)), name_(std::move(name)) {}

  std::vector<std::string> warnings() const override {
    std::vector<std::string> warnings = WrappedSource::warnings();
    if (2 * measured_scans_ >= scans_ || samples_.empty()) return warnings;
    warnings.push_back(
        fmt::format("{}: has samples of {:.3f} to {:.3f} s, the scans are of {:.3f} to {:.3f} s: "
                    "{} of {} scans have some; stamp them by the clock of the scans",
                    name_, samples_.front().stamp_s, samples_.back().stamp_s, first_stamp_s_,
                    last_stamp_s_, measured_scans_, scans_));
    return warnings;
  }

  std::optional<RecordedScan> next() override {
    std::optional<RecordedScan> scan = source_->next();
    if (!scan) return scan;
    scan->imu.clear();  // what was given wins over the recording's own
    const double half_s = 0.5 * source_->sensor().scan_period_s;
    while (next_ < samples_.size() && samples_[next_].stamp_s <= scan->stamp_s + half_s) {
      scan->imu.push_back(samples_[next_++]);
    }
    if (scans_++ == 0) first_stamp_s_ = scan->stamp_s;
    last_stamp_s_ = scan->stamp_s;
    if (!scan->imu.empty() && scan->imu.back().stamp_s >= scan->stamp_s - half_s) {
      ++measured_scans_;
    }
    return scan;
  }

 private:
  std::vector<ImuSample> samples_;
  std::string name_;
  std::size_t next_ = 0;
  std::int64_t scans_ = 0;
  std::int64_t measured_scans_ = 0;  ///< during which there were samples
  double first_stamp_s_ = 0.0;
  double last_stamp_s_ = 0.0;
};

}  // namespace

std::unique_ptr<ScanSource> open_scan_files(const std::string& path,
                                            const std::optional<SensorModel>& sensor,
                                            const ChooseSensor& choose,
                                            const RecordingOptions& options) {
  const fs::path recording(path);
  std::error_code error;
  if (fs::is_directory(recording, error)) return open_folder(recording, sensor, choose, options);
  if (!fs::is_regular_file(recording, error)) {
    throw Error("{}: expected a recording, found {}; give {}", path,
                fs::exists(recording, error) ? "neither a regular file nor a folder"
                                             : "no such file or folder",
                kKnownRecordings);
  }
  const fs::path extension = recording.extension();
  if (extension == ".npy") {
    if (!sensor) {
      throw Error(
          "{}: expected a sensor, which images do not determine; give --sensor NAME or "
          "--sensor FILE.json",
          path);
    }
    return make_image_stack_source(path, *sensor, options, wanted_stamps_s(path, options));
  }
  const auto is_one_of = [&](const auto& extensions) {
    return std::ranges::find(extensions, extension) != extensions.end();
  };
  if (is_one_of(kBinaryPoints) || is_one_of(kTextPoints)) {
    return make_file_scan_source({path}, choose, options);
  }
  throw Error("{}: expected a recording, found {}; give {}", path,
              extension == ".osf" ? "an Ouster's .osf file, of which 'ouster-cli source FILE.osf "
                                    "save .pcap' makes a capture"
                                  : fmt::format("a file named '{}'", extension.string()),
              kKnownRecordings);
}

std::unique_ptr<ScanSource> with_imu(std::unique_ptr<ScanSource> source,
                                     std::vector<ImuSample> samples, const std::string& name) {
  return std::make_unique<SourceWithImu>(std::move(source), std::move(samples), name);
}

}  // namespace hqslam::recordings

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hqslam/core/scan.h"
#include "hqslam/core/sensor_model.h"

namespace hqslam {

/// How a number is stored: F float of 4 or 8 bytes, I signed or U unsigned of 1, 2, 4 or 8.
struct StoredNumber {
  char type = 'F';
  std::size_t bytes = 4;
};

template <typename T>
double number_at(const void* bytes) {
  T value{};
  std::memcpy(&value, bytes, sizeof(T));
  return static_cast<double>(value);
}

inline double number_at(const void* bytes, StoredNumber stored) {
  if (stored.type == 'F') {
    return stored.bytes == 4 ? number_at<float>(bytes) : number_at<double>(bytes);
  }
  const bool is_signed = stored.type == 'I';
  switch (stored.bytes) {
    case 1:
      return is_signed ? number_at<std::int8_t>(bytes) : number_at<std::uint8_t>(bytes);
    case 2:
      return is_signed ? number_at<std::int16_t>(bytes) : number_at<std::uint16_t>(bytes);
    case 4:
      return is_signed ? number_at<std::int32_t>(bytes) : number_at<std::uint32_t>(bytes);
    default:
      return is_signed ? number_at<std::int64_t>(bytes) : number_at<std::uint64_t>(bytes);
  }
}

/// What every point of a file or a message has under one name.
struct PointField {
  std::string name;
  StoredNumber stored;
  std::size_t offset = 0;  ///< of its first number within a point: bytes, or of a text numbers
  std::size_t count = 1;   ///< numbers
};

/// The fields that matter: x, y, z, and where they are there ring, time and intensity, by any of
/// the names that drivers give them (see point_fields), and the confidence of hqslam's own maps.
struct PointFields {
  const PointField* x = nullptr;
  const PointField* y = nullptr;
  const PointField* z = nullptr;
  const PointField* ring = nullptr;
  const PointField* time = nullptr;
  const PointField* intensity = nullptr;
  const PointField* confidence = nullptr;
};
/// ring: also channel, line, laser_id and the like; time: t, time, timestamp, offset_time and the
/// like; intensity: reflectivity where there is one, else intensity. Capital letters, characters
/// between words, units in brackets and CloudCompare's "scalar_" do not matter. Throws Error unless
/// there are x, y and z. `source` stands for the file in messages, `kind` for its word for fields.
PointFields point_fields(const std::vector<PointField>& fields, const std::string& source,
                         const char* kind = "fields");

/// The times of a scan's points as a file or a message has them.
struct PointTimeField {
  std::string name;
  bool whole_numbers = false;
  std::vector<double> values;
  bool is_of_clock = false;  ///< by times_rise
};

/// Whether the times of a recording's scans rise by a turn or so from scan to scan, so that they
/// are those of a clock, whatever its zero; times that begin again with each scan do not. `fields`:
/// of scans in the order of recording. False for fewer than two scans with times.
bool times_rise(const std::vector<PointTimeField>& fields, double scan_period_s);

/// The times of a scan's points in seconds.
struct PointTimes {
  /// From the middle of the times; not a number for a time far from those of nearly all points.
  std::vector<float> offset_s;
  double middle_s = 0.0;  ///< by the field's own zero
  double duration_s = 0.0;
  /// Whether that zero is a clock's rather than the scan's own: PointTimeField::is_of_clock, or
  /// times too large for one scan.
  bool absolute = false;
};

/// Field -> seconds. The unit is that in which the times last about one turn of the sensor:
/// seconds, milli-, micro- or nanoseconds; where several would do, seconds for numbers with a
/// fraction and nanoseconds for whole ones. Nothing if all times are equal (a driver that fills in
/// 0). Throws Error if a time is not finite or if they last more than five quarters of a turn.
std::optional<PointTimes> point_times(const PointTimeField& field, double scan_period_s,
                                      const std::string& source);
/// The same; nothing also where it throws Error, which is reported with the scan.
std::optional<PointTimes> usable_times(const PointTimeField& field, double scan_period_s);

/// Rows from the numbers of rings, one per point. Some drivers number them from the highest beam
/// (Ouster), some from the lowest (Velodyne), which the correlation of ring and elevation decides;
/// rows count from the highest. Rings without such a correlation give no rows, and projection takes
/// the elevation. Throws Error for a ring that the sensor does not have, and for at
/// most half of its rings whose points are not where its beams look; `source` and `field` stand for
/// it in messages.
std::vector<std::uint16_t> rows_from_rings(const std::vector<double>& ring, const Scan& scan,
                                           const SensorModel& sensor, const std::string& source,
                                           const std::string& field);

/// Points with their rings and times as a file or a message has them.
struct RawPoints {
  Scan scan;
  std::vector<double> ring;  ///< per point; empty if there are none
  std::string ring_name;
  PointTimeField time;  ///< per point; empty if there are none

  /// Points without any other field.
  explicit RawPoints(Scan scan_) : scan(std::move(scan_)) {}
  RawPoints(const PointFields& fields, std::size_t points);
  /// value(field): the point's number. Keeps the point if it is finite and not at the origin;
  /// otherwise counts it.
  template <typename Value>
  void add(const PointFields& fields, const Value& value) {
    if (!add(value(*fields.x), value(*fields.y), value(*fields.z))) return;
    if (fields.ring != nullptr) ring.push_back(value(*fields.ring));
    if (fields.time != nullptr) time.values.push_back(value(*fields.time));
    if (fields.intensity != nullptr) {
      scan.intensity.push_back(static_cast<float>(value(*fields.intensity)));
    }
    if (fields.confidence != nullptr) {
      scan.confidence.push_back(static_cast<float>(value(*fields.confidence)));
    }
  }

 private:
  bool add(double x_m, double y_m, double z_m);
};

/// Endings of files of points.
inline constexpr std::array<const char*, 3> kBinaryPoints = {".bin", ".pcd", ".ply"};
inline constexpr std::array<const char*, 2> kTextPoints = {".csv", ".txt"};

/// A file of points, a scan or a map: .pcd, .ply, KITTI's .bin, and any other as text. Throws
/// Error.
RawPoints read_point_file(const std::string& path);

/// Rings to rows, times to offsets from their middle. The scan's stamp is that middle: by the
/// clock of the times; where they count from the message, whose stamp_s was given, from there;
/// where they are of another clock than the message's, the message is taken as the scan's
/// beginning. 0 without clock and message. `sensor` may be nullptr: then rows are left empty.
/// Throws Error.
Scan scan_of(RawPoints points, const SensorModel* sensor, const std::string& source,
             std::optional<double> stamp_s = std::nullopt);

}  // namespace hqslam

#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "hqslam/core/point_times.h"
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

/// The fields that matter: x, y, z, and where they are there ring (or channel) and time (t, time,
/// timestamp, time_stamp, timeStamp or offset_time).
struct PointFields {
  const PointField* x = nullptr;
  const PointField* y = nullptr;
  const PointField* z = nullptr;
  const PointField* ring = nullptr;
  const PointField* time = nullptr;
};
/// Throws Error unless there are x, y and z. `source` stands for the file in messages, `kind` for
/// what it calls its fields.
PointFields point_fields(const std::vector<PointField>& fields, const std::string& source,
                         const char* kind = "fields");

/// Points with their rings and times as a file or a message has them.
struct RawPoints {
  Scan scan;
  std::vector<double> ring;  ///< per point; empty if there are none
  std::string ring_name;
  PointTimeField time;  ///< per point; empty if there are none

  RawPoints(const PointFields& fields, std::size_t points);
  /// value(field): the point's number. Keeps the point if it is finite and not at the origin;
  /// otherwise counts it.
  template <typename Value>
  void add(const PointFields& fields, const Value& value) {
    if (!add(value(*fields.x), value(*fields.y), value(*fields.z))) return;
    if (fields.ring != nullptr) ring.push_back(value(*fields.ring));
    if (fields.time != nullptr) time.values.push_back(value(*fields.time));
  }

 private:
  bool add(double x_m, double y_m, double z_m);
};

/// Rings to rows, times to offsets. `sensor` may be nullptr: then rows are left empty. Throws
/// Error.
Scan scan_of(RawPoints points, const SensorModel* sensor, const std::string& path);

}  // namespace hqslam

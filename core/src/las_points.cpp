#include "las_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string_view>

#include "hqslam/core/error.h"
#include "hqslam/core/whole_file.h"
#include "point_files.h"

// A .las file is a header, records of variable length and the points, all little-endian. A point
// has coordinates in whole steps, an intensity, and by its format a GPS time and colours; behind
// that extra bytes, which a record of 192 bytes each describes: type, name, no scale.

namespace hqslam {

namespace {

constexpr std::size_t kMaxLasFileBytes = std::size_t{1} << 31U;
constexpr std::size_t kMaxLasPoints = std::size_t{1} << 26U;  // a large map
constexpr double kStep_m = 0.001;
/// Beyond, a float32 is off by more than a few millimetres.
constexpr double kFarthestPlace_m = 1e5;

constexpr std::size_t kHeaderBytes = 227;
constexpr std::size_t kHeaderBytes14 = 375;
constexpr std::size_t kRecordHeaderBytes = 54;
constexpr std::size_t kExtraBytes = 192;
constexpr const char* kExtraUser = "LASF_Spec";
constexpr std::uint16_t kExtraRecord = 4;
constexpr unsigned kScaledOrShifted = 0x18;  ///< of a description: its numbers, which is not read
constexpr std::size_t kIntensityAt = 12;
constexpr unsigned kCompressed = 0xC0;

/// Of a point format: bytes of a point, and where its time is; 0: nowhere, or a format not read.
struct Format {
  std::size_t bytes, time_at;
};
constexpr std::array<Format, 9> kFormats = {
    {{20, 0}, {28, 20}, {26, 0}, {34, 20}, {0, 0}, {0, 0}, {30, 22}, {36, 22}, {38, 22}}};

/// Types of extra bytes, from 1 on.
constexpr std::array<StoredNumber, 10> kLasTypes = {{{'U', 1},
                                                     {'I', 1},
                                                     {'U', 2},
                                                     {'I', 2},
                                                     {'U', 4},
                                                     {'I', 4},
                                                     {'U', 8},
                                                     {'I', 8},
                                                     {'F', 4},
                                                     {'F', 8}}};

std::uint8_t type_of(StoredNumber stored) {
  const auto found = std::ranges::find_if(kLasTypes, [&](StoredNumber known) {
    return known.type == stored.type && known.bytes == stored.bytes;
  });
  return static_cast<std::uint8_t>(found - kLasTypes.begin() + 1);
}

template <typename T>
void put(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}
void put_text(std::string& bytes, std::string_view text, std::size_t length) {
  bytes.append(text).append(length - text.size(), '\0');
}

template <typename T>
T number_in(std::string_view file, std::size_t at) {
  T value{};
  std::memcpy(&value, file.data() + at, sizeof(T));
  return value;
}

template <typename... Values>
[[noreturn]] void fail_in_las(const std::string& path, fmt::format_string<Values...> complaint,
                              Values&&... values) {
  throw Error("{}: {}; give a .las file of version 1.0 to 1.4", path,
              fmt::format(complaint, std::forward<Values>(values)...));
}

struct LasHeader {
  std::size_t points = 0;
  std::size_t points_at = 0;
  std::size_t point_bytes = 0;
  std::array<double, 3> step_m{}, origin_m{};
  std::vector<PointField> fields;  ///< x, y and z the first ones, in steps
};

/// Those of the records between header and points that describe extra bytes.
void add_extra_fields(std::string_view file, std::size_t at, LasHeader& header) {
  std::size_t offset = header.point_bytes;  // so far that of the format alone
  while (at + kRecordHeaderBytes <= header.points_at) {
    const std::string_view user = file.substr(at + 2, 16);
    const std::size_t length = number_in<std::uint16_t>(file, at + 20);
    const bool extra =
        user.starts_with(kExtraUser) && number_in<std::uint16_t>(file, at + 18) == kExtraRecord;
    at += kRecordHeaderBytes;
    const std::size_t end = std::min(at + length, header.points_at);
    for (std::size_t of = at; extra && of + kExtraBytes <= end; of += kExtraBytes) {
      const auto type = number_in<std::uint8_t>(file, of + 2);
      const auto options = number_in<std::uint8_t>(file, of + 3);
      if (type > kLasTypes.size()) return;  // what follows is not where we know
      if (type == 0) {
        offset += options;  // so many bytes that are no number
        continue;
      }
      const std::string_view name = file.substr(of + 4, 32);
      if ((options & kScaledOrShifted) == 0) {
        header.fields.push_back(
            {std::string(name.substr(0, name.find('\0'))), kLasTypes[type - 1], offset});
      }
      offset += kLasTypes[type - 1].bytes;
    }
    at = end;
  }
}

LasHeader read_las_header(std::string_view file, const std::string& path) {
  if (!file.starts_with("LASF")) fail_in_las(path, "expected a file that begins with 'LASF'");
  if (file.size() < kHeaderBytes) fail_in_las(path, "truncated: found {} bytes", file.size());
  const int minor = number_in<std::uint8_t>(file, 25);
  if (number_in<std::uint8_t>(file, 24) != 1 || minor > 4)
    fail_in_las(path, "expected another version");
  const std::size_t header_bytes = number_in<std::uint16_t>(file, 94);
  const auto format = number_in<std::uint8_t>(file, 104);
  if ((format & kCompressed) != 0 || path.ends_with(".laz")) {
    throw Error("{}: compressed points (LAZ) are not read; write them as .las first", path);
  }
  if (format >= kFormats.size() || kFormats[format].bytes == 0) {
    fail_in_las(path, "expected point format 0 to 3 or 6 to 8, found {}", format);
  }
  LasHeader header;
  header.points_at = number_in<std::uint32_t>(file, 96);
  header.point_bytes = number_in<std::uint16_t>(file, 105);
  std::uint64_t points = number_in<std::uint32_t>(file, 107);
  if (minor == 4 && points == 0 && header_bytes >= kHeaderBytes14 && file.size() >= header_bytes) {
    points = number_in<std::uint64_t>(file, 247);
  }
  if (header_bytes < kHeaderBytes || header.points_at < header_bytes ||
      header.points_at > file.size() || header.point_bytes < kFormats[format].bytes ||
      points > kMaxLasPoints || points > (file.size() - header.points_at) / header.point_bytes) {
    fail_in_las(path,
                "expected up to {} points of {} bytes at byte {}, found {} points in {} bytes",
                kMaxLasPoints, header.point_bytes, header.points_at, points, file.size());
  }
  header.points = points;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    header.step_m[axis] = number_in<double>(file, 131 + 8 * axis);
    header.origin_m[axis] = number_in<double>(file, 155 + 8 * axis);
    header.fields.push_back({std::string(1, static_cast<char>('x' + axis)), {'I', 4}, 4 * axis});
  }
  header.fields.push_back({"intensity", {'U', 2}, kIntensityAt});
  const Format& of = kFormats[format];
  if (of.time_at > 0) header.fields.push_back({"time", {'F', 8}, of.time_at});
  const std::size_t with_extra = header.point_bytes;
  header.point_bytes = of.bytes;
  add_extra_fields(file, header_bytes, header);
  header.point_bytes = with_extra;
  std::erase_if(header.fields, [&](const PointField& field) {
    return field.offset + field.stored.bytes > with_extra;
  });
  return header;
}

}  // namespace

RawPoints read_las_points(const std::string& path) {
  const std::string file = whole_file(path, "a .las file", kMaxLasFileBytes);
  const LasHeader header = read_las_header(file, path);
  const PointFields fields = point_fields(header.fields, path);
  RawPoints points(fields, header.points);
  for (std::size_t i = 0; i < header.points; ++i) {
    const char* const point = file.data() + header.points_at + i * header.point_bytes;
    points.add(fields, [&](const PointField& field) {
      const double stored = number_at(point + field.offset, field.stored);
      const auto axis = static_cast<std::size_t>(&field - header.fields.data());
      if (axis >= 3) return stored;
      const double place_m = stored * header.step_m[axis] + header.origin_m[axis];
      if (std::abs(place_m) <= kFarthestPlace_m) return place_m;
      throw Error(
          "{}: expected points within {} km of the origin, found a coordinate of {:.1f} m; shift "
          "the cloud there first",
          path, 1e-3 * kFarthestPlace_m, place_m);
    });
  }
  return points;
}

LasPoints::LasPoints(const std::vector<PointColumn>& columns, std::size_t points,
                     const std::string& path)
    : columns_(columns), points_(points) {
  for (std::size_t i = 3; i < columns.size(); ++i) {
    const std::string_view name = columns[i].name;
    const PointColumn** const place = name == "intensity"   ? &intensity_
                                      : name == "timestamp" ? &time_
                                                            : nullptr;
    (place != nullptr ? *place : extra_.emplace_back()) = &columns[i];
  }
  point_bytes_ = kFormats[time_ != nullptr ? 1 : 0].bytes;
  for (const PointColumn* extra : extra_) point_bytes_ += extra->stored.bytes;
  double largest = 0.0;
  for (std::size_t point = 0; point < points; ++point) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double steps = std::round(number(columns[axis], point) / kStep_m);
      if (!(std::abs(steps) <= std::numeric_limits<std::int32_t>::max())) {
        throw Error("{}: expected coordinates up to 2,147,483 m, found {:.1f} m; write a .ply file",
                    path, steps * kStep_m);
      }
      low_m_[axis] = point == 0 ? steps * kStep_m : std::min(low_m_[axis], steps * kStep_m);
      high_m_[axis] = point == 0 ? steps * kStep_m : std::max(high_m_[axis], steps * kStep_m);
    }
    if (intensity_ == nullptr) continue;
    const double intensity = number(*intensity_, point);
    if (std::isfinite(intensity)) largest = std::max(largest, intensity);
  }
  constexpr double kMost = 65535.0;
  intensity_steps_ = largest <= 1.0     ? kMost
                     : largest <= 255.0 ? kMost / 255.0
                     : largest <= kMost ? 1.0
                                        : kMost / largest;
  if (points > std::numeric_limits<std::uint32_t>::max()) {
    throw Error("{}: expected up to 4,294,967,295 points, found {}; write a .ply file", path,
                points);
  }
}

double LasPoints::number(const PointColumn& column, std::size_t point) const {
  return number_at(static_cast<const char*>(column.first) + point * column.step_bytes,
                   column.stored);
}

std::string LasPoints::header() const {
  const auto extra_bytes = static_cast<std::uint16_t>(kExtraBytes * extra_.size());
  const std::size_t records = extra_.empty() ? 0 : kRecordHeaderBytes + extra_bytes;
  std::string bytes = "LASF";
  bytes.append(20, '\0');             // no source, no encoding, no identifier
  put<std::uint16_t>(bytes, 0x0201);  // version 1.2
  put_text(bytes, "hqslam", 32);
  put_text(bytes, "hqslam", 32);
  put<std::uint32_t>(bytes, 0);  // no date: the same points are the same bytes
  put<std::uint16_t>(bytes, kHeaderBytes);
  put(bytes, static_cast<std::uint32_t>(kHeaderBytes + records));
  put<std::uint32_t>(bytes, extra_.empty() ? 0 : 1);
  put<std::uint8_t>(bytes, time_ != nullptr ? 1 : 0);
  put(bytes, static_cast<std::uint16_t>(point_bytes_));
  for (const std::size_t count : {points_, points_}) put(bytes, static_cast<std::uint32_t>(count));
  bytes.append(16, '\0');  // second to fifth returns
  for (int axis = 0; axis < 3; ++axis) put(bytes, kStep_m);
  for (int axis = 0; axis < 3; ++axis) put(bytes, 0.0);
  for (int axis = 0; axis < 3; ++axis) {
    put(bytes, high_m_[axis]);
    put(bytes, low_m_[axis]);
  }
  if (extra_.empty()) return bytes;
  put<std::uint16_t>(bytes, 0);
  put_text(bytes, kExtraUser, 16);
  put(bytes, kExtraRecord);
  put(bytes, extra_bytes);
  put_text(bytes, "", 32);
  for (const PointColumn* extra : extra_) {
    put<std::uint16_t>(bytes, 0);
    put(bytes, type_of(extra->stored));
    put<std::uint8_t>(bytes, 0);
    put_text(bytes, extra->name, 32);
    put_text(bytes, "", kExtraBytes - 36);
  }
  return bytes;
}

void LasPoints::append(std::size_t point, std::string& bytes) const {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    put(bytes, static_cast<std::int32_t>(std::lround(number(columns_[axis], point) / kStep_m)));
  }
  const double intensity = intensity_ == nullptr ? 0.0 : number(*intensity_, point);
  put(bytes,
      static_cast<std::uint16_t>(intensity > 0.0 && std::isfinite(intensity)
                                     ? std::lround(std::min(intensity * intensity_steps_, 65535.0))
                                     : 0));
  put<std::uint8_t>(bytes, 0b00'001'001);  // return 1 of 1
  bytes.append(5, '\0');                   // no class, angle, user data, source
  if (time_ != nullptr) put(bytes, number(*time_, point));
  for (const PointColumn* extra : extra_) {
    bytes.append(static_cast<const char*>(extra->first) + point * extra->step_bytes,
                 extra->stored.bytes);
  }
}

}  // namespace hqslam

#include "point_cloud_message.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "bag.h"
#include "hqslam/core/error.h"
#include "hqslam/core/excerpt.h"
#include "message_reader.h"

namespace hqslam::recordings {

namespace {

constexpr std::size_t kMaxFields = 200;
constexpr std::size_t kMaxPoints = 33'000'000;
/// sensor_msgs/PointField: INT8 UINT8 INT16 UINT16 INT32 UINT32 FLOAT32 FLOAT64, from 1 on.
constexpr std::array<std::size_t, 9> kTypeBytes = {0, 1, 1, 2, 2, 4, 4, 4, 8};
constexpr std::uint8_t kFloat32 = 7;
constexpr std::uint8_t kFloat64 = 8;

struct Field {
  std::string name;
  std::size_t offset = 0;
  std::uint8_t type = 0;

  bool whole() const { return type != kFloat32 && type != kFloat64; }
};

double value_at(const std::uint8_t* point, const Field& field) {
  const std::uint8_t* const at = point + field.offset;
  switch (field.type) {
    case 1:
      return little_endian<std::int8_t>(at);
    case 2:
      return little_endian<std::uint8_t>(at);
    case 3:
      return little_endian<std::int16_t>(at);
    case 4:
      return little_endian<std::uint16_t>(at);
    case 5:
      return little_endian<std::int32_t>(at);
    case 6:
      return little_endian<std::uint32_t>(at);
    case kFloat32:
      return double{little_endian<float>(at)};
    default:
      return little_endian<double>(at);
  }
}

/// The layout of a message's points.
struct Layout {
  std::size_t height = 0, width = 0, point_step = 0, row_step = 0;
  std::vector<Field> fields;
  Bytes data;

  const Field* find(std::initializer_list<std::string_view> names) const {
    for (const std::string_view name : names) {
      const auto found = std::find_if(fields.begin(), fields.end(),
                                      [&](const Field& field) { return field.name == name; });
      if (found != fields.end()) return &*found;
    }
    return nullptr;
  }
};

Layout read_layout(MessageReader& reader) {
  Layout layout;
  layout.height = reader.u32();
  layout.width = reader.u32();
  const std::uint32_t fields = reader.u32();
  if (fields > kMaxFields) {
    throw Error(fmt::format("expected at most {} fields of a point, found {}", kMaxFields, fields));
  }
  for (std::uint32_t i = 0; i < fields; ++i) {
    Field field;
    field.name = reader.words();
    field.offset = reader.u32();
    field.type = reader.u8();
    reader.u32();  // how many: of the fields that matter, one
    if (field.type >= 1 && field.type <= kFloat64) layout.fields.push_back(std::move(field));
  }
  const bool big_endian = reader.u8() != 0;
  layout.point_step = reader.u32();
  layout.row_step = reader.u32();
  layout.data = reader.byte_list();
  if (big_endian) throw Error("expected points in little-endian order, found big-endian ones");
  return layout;
}

void check(const Layout& layout) {
  const bool fits =
      layout.height == 0 || layout.width == 0 ||
      (layout.point_step > 0 && layout.width <= layout.data.size() / layout.point_step &&
       layout.row_step >= layout.width * layout.point_step &&
       layout.height <= layout.data.size() / layout.row_step &&
       layout.height <= kMaxPoints / layout.width);
  if (!fits) {
    throw Error(fmt::format("expected {} x {} points of {} bytes, found {} bytes in all",
                            layout.height, layout.width, layout.point_step, layout.data.size()));
  }
  for (const Field& field : layout.fields) {
    if (field.offset + kTypeBytes[field.type] > layout.point_step) {
      throw Error(
          fmt::format("field '{}': expected it within the {} bytes of a point, found it at {}",
                      excerpt(field.name, kNameCharacters), layout.point_step, field.offset));
    }
  }
}

const Field& coordinate(const Layout& layout, std::string_view name) {
  if (const Field* field = layout.find({name})) return *field;
  std::string found;
  for (const Field& field : layout.fields) found += (found.empty() ? "" : " ") + field.name;
  throw Error(fmt::format("expected fields x y z, found {}", excerpt(found, kNameCharacters)));
}

}  // namespace

std::int64_t point_cloud_stamp_ns(const Message& message) {
  return MessageReader(message).header_ns();
}

PointCloudMessage read_point_cloud(const Message& message) {
  MessageReader reader(message);
  PointCloudMessage cloud;
  cloud.stamp_ns = reader.header_ns();
  const Layout layout = read_layout(reader);
  check(layout);
  const Field& x = coordinate(layout, "x");
  const Field& y = coordinate(layout, "y");
  const Field& z = coordinate(layout, "z");
  const Field* const ring = layout.find({"ring", "channel"});
  const Field* const time =
      layout.find({"t", "time", "timestamp", "time_stamp", "timeStamp", "offset_time"});
  if (ring != nullptr) cloud.ring_name = ring->name;
  if (time != nullptr) {
    cloud.time.name = time->name;
    cloud.time.whole_numbers = time->whole();
  }
  // Rows without a column may be announced by the thousand million.
  const std::size_t rows = layout.width == 0 ? 0 : layout.height;
  cloud.scan.points_m.reserve(rows * layout.width);
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t column = 0; column < layout.width; ++column) {
      const std::uint8_t* const point =
          layout.data.data() + row * layout.row_step + column * layout.point_step;
      const Eigen::Vector3f point_m(static_cast<float>(value_at(point, x)),
                                    static_cast<float>(value_at(point, y)),
                                    static_cast<float>(value_at(point, z)));
      if (!point_m.allFinite() || point_m.isZero(0.0F)) {
        ++cloud.scan.invalid_points;
        continue;
      }
      cloud.scan.points_m.push_back(point_m);
      if (ring != nullptr) cloud.ring.push_back(value_at(point, *ring));
      if (time != nullptr) cloud.time.values.push_back(value_at(point, *time));
    }
  }
  return cloud;
}

}  // namespace hqslam::recordings

#include "bags/point_cloud.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "bags/message_packets.h"
#include "hqslam/core/error.h"
#include "hqslam/core/excerpt.h"

namespace hqslam::recordings {

namespace {

constexpr std::size_t kMaxFields = 200;
constexpr std::size_t kMaxPoints = 33'000'000;
/// sensor_msgs/PointField: INT8 UINT8 INT16 UINT16 INT32 UINT32 FLOAT32 FLOAT64, from 1 on.
constexpr std::array<StoredNumber, 8> kTypes = {
    {{'I', 1}, {'U', 1}, {'I', 2}, {'U', 2}, {'I', 4}, {'U', 4}, {'F', 4}, {'F', 8}}};

/// The layout of a message's points.
struct Layout {
  std::size_t height = 0, width = 0, point_step = 0, row_step = 0;
  std::vector<PointField> fields;
  Bytes data;
  bool big_endian = false;  ///< the message's flag, which some writers set for little-endian data
};

Layout read_layout(MessageReader& reader) {
  Layout layout;
  layout.height = reader.u32();
  layout.width = reader.u32();
  const std::uint32_t fields = reader.u32();
  if (fields > kMaxFields) {
    throw Error("expected at most {} fields of a point, found {}", kMaxFields, fields);
  }
  for (std::uint32_t i = 0; i < fields; ++i) {
    PointField field;
    field.name = reader.words();
    field.offset = reader.u32();
    const std::uint8_t type = reader.u8();
    reader.u32();  // how many: of the fields that matter, one
    if (type < 1 || type > kTypes.size()) continue;
    field.stored = kTypes[type - 1];
    layout.fields.push_back(std::move(field));
  }
  const bool big_endian = reader.u8() != 0;
  layout.point_step = reader.u32();
  layout.row_step = reader.u32();
  layout.data = reader.byte_list();
  layout.big_endian = big_endian;
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
    throw Error("expected {} x {} points of {} bytes, found {} bytes in all", layout.height,
                layout.width, layout.point_step, layout.data.size());
  }
  for (const PointField& field : layout.fields) {
    if (field.offset + field.stored.bytes > layout.point_step) {
      throw Error("field '{}': expected it within the {} bytes of a point, found it at {}",
                  excerpt(field.name, kNameCharacters), layout.point_step, field.offset);
    }
  }
}

/// A number in the other order of bytes.
double swapped_number_at(const std::uint8_t* bytes, StoredNumber stored) {
  std::array<std::uint8_t, 8> swapped{};
  std::reverse_copy(bytes, bytes + stored.bytes, swapped.begin());
  return number_at(swapped.data(), stored);
}

/// Whether the coordinates of the most points are in metres only in the other order of bytes.
bool is_big_endian(const Layout& layout, const PointField& x) {
  constexpr double kFarthest_m = 1e4;
  constexpr double kNearest_m = 1e-4;  // in the wrong order next to all are smaller or larger
  std::int64_t balance = 0;
  for (std::size_t at = x.offset; at + 8 <= layout.data.size(); at += layout.point_step) {
    const auto in_metres = [](double value) {
      return std::abs(value) > kNearest_m && std::abs(value) < kFarthest_m ? 1 : 0;
    };
    balance += in_metres(swapped_number_at(layout.data.data() + at, x.stored)) -
               in_metres(number_at(layout.data.data() + at, x.stored));
  }
  return balance > 0;
}

}  // namespace

double point_cloud_stamp_s(const Message& message) {
  const std::int64_t stamp_ns = MessageReader(message).header().time_ns;
  return 1e-9 * static_cast<double>(stamp_ns != 0 ? stamp_ns : message.time_ns);
}

RawPoints read_point_cloud(const Message& message, const std::string& source) {
  MessageReader reader(message);
  reader.header();
  const Layout layout = read_layout(reader);
  check(layout);
  // Rows without a column may be announced by the thousand million.
  const std::size_t rows = layout.width == 0 ? 0 : layout.height;
  const PointFields fields = point_fields(layout.fields, source);
  RawPoints points(fields, rows * layout.width);
  const bool swap = layout.big_endian && is_big_endian(layout, *fields.x);
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t column = 0; column < layout.width; ++column) {
      const std::uint8_t* const point =
          layout.data.data() + row * layout.row_step + column * layout.point_step;
      points.add(fields, [&](const PointField& field) {
        return swap ? swapped_number_at(point + field.offset, field.stored)
                    : number_at(point + field.offset, field.stored);
      });
    }
  }
  return points;
}

}  // namespace hqslam::recordings

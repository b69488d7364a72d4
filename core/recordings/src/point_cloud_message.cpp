#include "point_cloud_message.h"

#include <fmt/format.h>

#include <array>

#include "bag.h"
#include "hqslam/core/error.h"
#include "hqslam/core/excerpt.h"
#include "message_reader.h"

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
  for (const PointField& field : layout.fields) {
    if (field.offset + field.stored.bytes > layout.point_step) {
      throw Error(
          fmt::format("field '{}': expected it within the {} bytes of a point, found it at {}",
                      excerpt(field.name, kNameCharacters), layout.point_step, field.offset));
    }
  }
}

}  // namespace

std::int64_t point_cloud_stamp_ns(const Message& message) {
  return MessageReader(message).header_ns();
}

RawPoints read_point_cloud(const Message& message, const std::string& source) {
  MessageReader reader(message);
  reader.header_ns();
  const Layout layout = read_layout(reader);
  check(layout);
  // Rows without a column may be announced by the thousand million.
  const std::size_t rows = layout.width == 0 ? 0 : layout.height;
  const PointFields fields = point_fields(layout.fields, source);
  RawPoints points(fields, rows * layout.width);
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t column = 0; column < layout.width; ++column) {
      const std::uint8_t* const point =
          layout.data.data() + row * layout.row_step + column * layout.point_step;
      points.add(fields, [&](const PointField& field) {
        return number_at(point + field.offset, field.stored);
      });
    }
  }
  return points;
}

}  // namespace hqslam::recordings

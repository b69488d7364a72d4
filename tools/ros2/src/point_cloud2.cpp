#include "point_cloud2.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <rclcpp/rclcpp.hpp>
#include <sensor_msgs/point_cloud2_iterator.hpp>

#include "hqslam/core/error.h"

namespace hqslam_ros {

namespace {

using sensor_msgs::msg::PointField;

const PointField* field_of(const PointCloud2& message, std::initializer_list<const char*> names) {
  for (const char* name : names) {
    for (const PointField& field : message.fields) {
      if (field.name == name) return &field;
    }
  }
  return nullptr;
}

/// A number of whatever type the driver writes. Throws Error where a point has no room for it.
double number_at(const PointCloud2& message, const PointField& field, std::size_t at) {
  const auto as = [&](auto value) {
    if (field.offset > message.point_step || message.point_step - field.offset < sizeof value) {
      throw hqslam::Error("{}: expected it within the {} bytes of a point, found it at {}",
                          field.name, message.point_step, field.offset);
    }
    std::memcpy(&value, &message.data[at + field.offset], sizeof value);
    return static_cast<double>(value);
  };
  switch (field.datatype) {
    case PointField::INT8:
      return as(std::int8_t());
    case PointField::UINT8:
      return as(std::uint8_t());
    case PointField::INT16:
      return as(std::int16_t());
    case PointField::UINT16:
      return as(std::uint16_t());
    case PointField::INT32:
      return as(std::int32_t());
    case PointField::UINT32:
      return as(std::uint32_t());
    case PointField::FLOAT32:
      return as(float());
    default:
      return as(double());
  }
}

/// Where each point of a message begins. Throws Error for a message shorter than its header states.
std::vector<std::size_t> beginnings_of(const PointCloud2& message) {
  const std::size_t width = message.width;
  const std::size_t used = width * message.point_step;
  const bool fits =
      message.height == 0 ||
      (message.row_step >= used && message.data.size() / message.height >= message.row_step);
  if (used == 0 || !fits) {
    throw hqslam::Error("expected {} x {} points of {} bytes, found {} bytes in all",
                        message.height, width, message.point_step, message.data.size());
  }
  std::vector<std::size_t> result;
  for (std::size_t row = 0; row < message.height; ++row) {
    for (std::size_t column = 0; column < width; ++column) {
      result.push_back(row * message.row_step + column * message.point_step);
    }
  }
  return result;
}

}  // namespace

hqslam::Scan scan_of(const PointCloud2& message) {
  const PointField* x = field_of(message, {"x"});
  const PointField* y = field_of(message, {"y"});
  const PointField* z = field_of(message, {"z"});
  const PointField* time = field_of(message, {"t", "time", "timestamp"});
  if (!x || !y || !z || !time) {
    throw hqslam::Error("points need the fields x, y, z and t or time");
  }
  const bool seconds =
      time->datatype == PointField::FLOAT32 || time->datatype == PointField::FLOAT64;
  hqslam::Scan scan;
  std::vector<double> times_s;
  for (const std::size_t at : beginnings_of(message)) {
    const Eigen::Vector3f point_m(static_cast<float>(number_at(message, *x, at)),
                                  static_cast<float>(number_at(message, *y, at)),
                                  static_cast<float>(number_at(message, *z, at)));
    if (!point_m.allFinite() || point_m.isZero(0.0F)) {  // drivers give it any time
      ++scan.invalid_points;
      continue;
    }
    times_s.push_back((seconds ? 1.0 : 1e-9) * number_at(message, *time, at));
    scan.points_m.push_back(point_m);
  }
  if (scan.points_m.empty()) throw hqslam::Error("a message without points");
  const auto [first_s, last_s] = std::ranges::minmax_element(times_s);
  const double middle_s = (*first_s + *last_s) / 2.0;
  for (const double time_s : times_s) {
    scan.time_offset_s.push_back(static_cast<float>(time_s - middle_s));
  }
  constexpr double kSmallestClock_s = 1e6;
  scan.stamp_s = middle_s;
  if (middle_s < kSmallestClock_s) scan.stamp_s += rclcpp::Time(message.header.stamp).seconds();
  return scan;
}

PointCloud2 message_of(const std::vector<Eigen::Vector3f>& points_m,
                       const std_msgs::msg::Header& header) {
  PointCloud2 message;
  message.header = header;
  sensor_msgs::PointCloud2Modifier modifier(message);
  modifier.setPointCloud2FieldsByString(1, "xyz");
  modifier.resize(points_m.size());
  sensor_msgs::PointCloud2Iterator<float> to(message, "x");
  for (const Eigen::Vector3f& point_m : points_m) {
    for (int axis = 0; axis < 3; ++axis) to[axis] = point_m[axis];
    ++to;
  }
  return message;
}

}  // namespace hqslam_ros

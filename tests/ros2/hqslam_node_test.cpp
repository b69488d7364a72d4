#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#define main main_of_the_node
#include "hqslam_node.cpp"
#undef main

#include "slam/yard_drive.h"

namespace {

constexpr double kClock_s = 1'700'000'000.0;

/// A scan as drivers send it: x y z as float32, and the points' times in a field of this type.
struct Sent {
  std::uint8_t type = PointField::FLOAT64;
  const char* time = "timestamp";
  std::size_t time_bytes = 8;
  double unit_s = 1.0;
  double first_s = kClock_s;  ///< what the field counts
};

template <typename T>
void put(std::vector<std::uint8_t>& data, std::size_t at, T value) {
  std::memcpy(&data[at], &value, sizeof value);
}

/// The scan begins at kClock_s + begin_s.
PointCloud2 message_of(const hqslam::OrganizedCloud& cloud, const Sent& sent, double begin_s) {
  PointCloud2 message;
  message.header.stamp = rclcpp::Time(static_cast<std::int64_t>(1e9 * (kClock_s + begin_s)));
  message.header.frame_id = "lidar";
  message.fields = {{"x", 0, PointField::FLOAT32, 1},
                    {"y", 4, PointField::FLOAT32, 1},
                    {"z", 8, PointField::FLOAT32, 1},
                    {sent.time, 12, sent.type, 1}};
  message.point_step = 20;
  for (std::size_t i = 0; i < cloud.range_m.size(); ++i) {
    if (cloud.range_m[i] <= 0.0F) continue;
    const std::size_t at = message.data.size();
    message.data.resize(at + message.point_step);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      put(message.data, at + 4 * axis, cloud.points_m[i][static_cast<Eigen::Index>(axis)]);
    }
    const double since_begin_s = 0.05 + cloud.time_offset_s[i];
    const double time =
        (sent.first_s + (sent.first_s > 0.0 ? begin_s : 0.0) + since_begin_s) / sent.unit_s;
    if (sent.type == PointField::FLOAT64) put(message.data, at + 12, time);
    if (sent.type == PointField::FLOAT32) put(message.data, at + 12, static_cast<float>(time));
    if (sent.type == PointField::UINT32)
      put(message.data, at + 12, static_cast<std::uint32_t>(time));
    ++message.width;
  }
  message.row_step = message.width * message.point_step;
  return message;
}

hqslam::SensorModel sensor() { return hqslam::sensor_preset("os1-16"); }

hqslam::OrganizedCloud scan(int i) { return hqslam::test::drive_scan(sensor(), i); }

void take(const PointCloud2& message) {
  rclcpp::Subscription<PointCloud2>::callback(std::make_shared<const PointCloud2>(message));
}

}  // namespace

TEST_CASE("times of a clock, of the message's stamp, in seconds and in nanoseconds are one time") {
  const hqslam::OrganizedCloud cloud = scan(3);
  for (const Sent& sent : {Sent{}, Sent{PointField::FLOAT32, "time", 4, 1.0, 0.0},
                           Sent{PointField::UINT32, "t", 4, 1e-9, 0.0}}) {
    CAPTURE(sent.time);
    const hqslam::Scan read = scan_of(message_of(cloud, sent, 0.3));
    CHECK(read.stamp_s - kClock_s == doctest::Approx(0.35).epsilon(0.01));
    std::size_t point = 0;
    for (std::size_t i = 0; i < cloud.range_m.size(); ++i) {
      if (cloud.range_m[i] <= 0.0F) continue;
      REQUIRE(std::abs(read.time_offset_s[point] - cloud.time_offset_s[i]) < 1e-4);
      ++point;
    }
    CHECK(point == read.time_offset_s.size());
  }
}

TEST_CASE("options that are whole numbers take whole numbers, the others numbers") {
  for (const hqslam::slam::NamedOption& option : hqslam::slam::option_table()) {
    CAPTURE(option.name);
    const double usual = option.get({});
    auto& given = rclcpp::Node::given[std::string(option.name)];
    if (option.is_whole) {
      given = static_cast<std::int64_t>(usual);
    } else {
      given = usual;
    }
  }
  CHECK_NOTHROW(HqslamNode());
  rclcpp::Node::given.clear();
}

TEST_CASE("a drive's messages become poses with the stamps of their scans, padded rows or not") {
  const HqslamNode node;
  auto& odometry = rclcpp::Publisher<nav_msgs::msg::Odometry>::published;
  odometry.clear();
  for (int i = 0; i < 6; ++i) {
    PointCloud2 message = message_of(scan(i), {}, 0.1 * i);
    if (i == 4) {  // two rows, with room behind each
      message.height = 2;
      message.width /= 2;
      message.row_step = message.width * message.point_step + 8;
      message.data.insert(message.data.begin() + message.row_step - 8, 8, 0xFF);
      message.data.resize(2 * message.row_step);
    }
    take(message);
  }
  REQUIRE(odometry.size() == 6);
  for (int i = 0; i < 6; ++i) {
    const hqslam::Pose truth =
        hqslam::test::drive_pose(0.0).inverse() * hqslam::test::drive_pose(0.1 * i);
    const auto& found = odometry[static_cast<std::size_t>(i)];
    CHECK(std::abs(found.pose.pose.position.x - truth.translation().x()) < 0.05);
    CHECK(std::abs(found.pose.pose.position.y - truth.translation().y()) < 0.05);
    CHECK(rclcpp::Time(found.header.stamp).seconds() - kClock_s ==
          doctest::Approx(0.05 + 0.1 * i).epsilon(0.01));
    CHECK(found.child_frame_id == "lidar");
  }
}

TEST_CASE("a message that is shorter than it says, or has no times, is left out and named") {
  const HqslamNode node;
  const PointCloud2 good = message_of(scan(0), {}, 0.0);
  auto& warnings = rclcpp::Node::warnings;
  const auto warned = [&](const auto& damage) {
    PointCloud2 message = good;
    damage(message);
    warnings.clear();
    take(message);
    return warnings.size() == 1;
  };
  CHECK_FALSE(warned([](PointCloud2&) {}));
  CHECK(warned([](PointCloud2& m) { m.data.pop_back(); }));
  CHECK(warned([](PointCloud2& m) { m.height = 1U << 30; }));
  CHECK(warned([](PointCloud2& m) { m.point_step = 0; }));
  CHECK(warned([](PointCloud2& m) { m.row_step = 1; }));
  CHECK(warned([](PointCloud2& m) { m.fields[0].offset = 18; }));
  CHECK(warned([](PointCloud2& m) { m.fields[3].offset = 0xFFFFFFFF; }));
  CHECK(warned([](PointCloud2& m) { m.fields.pop_back(); }));
  CHECK(warned([](PointCloud2& m) {
    m.width = 0;
    m.data.clear();
  }));
}

TEST_CASE("of a pose of which nothing is known the covariance stays infinite in the map's frame") {
  const hqslam::Pose turned = hqslam::pose_from_xyz_rpy({1.0, 2.0, 3.0}, 0.0, 0.0, 1.0);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Matrix6 covariance = Matrix6::Identity();
  CHECK(in_map(covariance, turned).isApprox(covariance));
  covariance.diagonal().setConstant(kInfinity);
  CHECK(in_map(covariance, turned) == covariance);
}

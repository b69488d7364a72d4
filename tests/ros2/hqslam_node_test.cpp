#include "hqslam_node.cpp"

#include <cstring>
#include <fstream>

#include "slam/yard_drive.h"
#include "testing.h"

namespace hqslam_ros {
namespace {

using sensor_msgs::msg::PointField;
using Odometry = nav_msgs::msg::Odometry;
using Located = geometry_msgs::msg::PoseWithCovarianceStamped;

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
PointCloud2 as_sent(const hqslam::OrganizedCloud& cloud, const Sent& sent, double begin_s) {
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

template <typename Message>
void take(const Message& message) {
  rclcpp::Subscription<Message>::callback(std::make_shared<const Message>(message));
}

/// Of a robot at rest, kClock_s + time_s.
Imu sample(double time_s) {
  Imu message;
  message.header.frame_id = "imu";
  message.header.stamp = time_of(kClock_s + time_s);
  message.linear_acceleration.z = hqslam::kGravity_mps2;
  return message;
}

constexpr double kAheadOfBase_m = 0.5;

/// A node on a robot whose LiDAR is where tf says, with these parameters; nothing was sent yet.
HqslamNode node_with(const std::map<std::string, rclcpp::Node::Parameter>& given = {}) {
  tf2_ros::Buffer::known.clear();
  tf2_ros::Buffer::known[{"base_link", "lidar"}] =
      message_of(hqslam::pose_from_xyz_rpy({kAheadOfBase_m, 0.0, 1.2}, 0.0, 0.0, 0.0), {}, "lidar");
  tf2_ros::Buffer::known[{"lidar", "imu"}] = message_of(Pose::Identity(), {}, "imu");
  rclcpp::Publisher<Odometry>::published.clear();
  rclcpp::Publisher<Located>::published.clear();
  rclcpp::Publisher<PointCloud2>::published.clear();
  rclcpp::Subscription<Imu>::publishers = 0;
  tf2_ros::TransformBroadcaster::sent.clear();
  rclcpp::Node::warnings.clear();
  rclcpp::Node::given = given;
  return HqslamNode(rclcpp::NodeOptions());
}

/// The last that was sent between two frames.
Pose sent(const std::string& parent, const std::string& child) {
  const auto& all = tf2_ros::TransformBroadcaster::sent;
  const auto last = std::find_if(all.rbegin(), all.rend(), [&](const TransformStamped& message) {
    return message.header.frame_id == parent && message.child_frame_id == child;
  });
  REQUIRE(last != all.rend());
  return pose_of(*last);
}

/// Names in a YAML file of parameters, as other_names.name, with their values as text.
std::map<std::string, std::string> parameters_of(const std::string& path) {
  std::map<std::string, std::string> result;
  std::ifstream file(path);
  std::string group;
  for (std::string line; std::getline(file, line);) {
    const std::size_t begin = line.find_first_not_of(' ');
    if (begin == std::string::npos || begin < 4 || line[begin] == '#') continue;
    const std::size_t colon = line.find(':');
    const std::string name = line.substr(begin, colon - begin);
    const std::string value = colon + 2 < line.size() ? line.substr(colon + 2) : "";
    if (value.empty()) {
      group = name + ".";
    } else {
      result[(begin > 4 ? group : "") + name] = value == "\"\"" ? "" : value;
    }
  }
  return result;
}

/// Whether a YAML value is of a parameter's type, and its default.
bool is_default(const std::string& value, const rclcpp::Node::Parameter& usual) {
  if (const auto* text = std::get_if<std::string>(&usual)) return value == *text;
  if (const auto* flag = std::get_if<bool>(&usual)) return value == (*flag ? "true" : "false");
  if (const auto* whole = std::get_if<std::int64_t>(&usual)) return value == std::to_string(*whole);
  return value.find('.') != std::string::npos && std::stod(value) == std::get<double>(usual);
}

}  // namespace

TEST_CASE("times of a clock, of the message's stamp, in seconds and in nanoseconds are one time") {
  const hqslam::OrganizedCloud cloud = scan(3);
  for (const Sent& sent : {Sent{}, Sent{PointField::FLOAT32, "time", 4, 1.0, 0.0},
                           Sent{PointField::UINT32, "t", 4, 1e-9, 0.0}}) {
    CAPTURE(sent.time);
    const hqslam::Scan read = scan_of(as_sent(cloud, sent, 0.3));
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

TEST_CASE("what is no point, at the origin or not a number, has no say in a scan's times") {
  const PointCloud2 good = as_sent(scan(3), {}, 0.3);
  const hqslam::Scan expected = scan_of(good);
  for (const float x_m : {0.0F, std::nanf("")}) {
    CAPTURE(x_m);
    PointCloud2 message = good;
    message.data.insert(message.data.begin(), message.point_step, 0);
    put(message.data, 0, x_m);
    ++message.width;
    message.row_step += message.point_step;
    const hqslam::Scan read = scan_of(message);
    CHECK(read.stamp_s == expected.stamp_s);
    CHECK(read.time_offset_s == expected.time_offset_s);
    CHECK(read.points_m == expected.points_m);
    CHECK(read.invalid_points == 1);
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
  const auto given = rclcpp::Node::given;
  CHECK_NOTHROW(node_with(given));
}

TEST_CASE("the parameters of the installed file are the node's, and so are their values") {
  const HqslamNode node = node_with();
  const auto& declared = rclcpp::Node::declared;
  const auto file = parameters_of(HQSLAM_ROS2_PARAMETERS);
  CHECK(file.size() >= 14);
  for (const auto& [name, value] : file) {
    CAPTURE(name);
    REQUIRE(declared.contains(name));
    CHECK(is_default(value, declared.at(name)));
  }
  for (const auto& [name, usual] : declared) {
    CAPTURE(name);
    CHECK((name.find('.') != std::string::npos || name == "lidar_in_base" || file.contains(name)));
  }
  CHECK_FALSE(declared.contains("mounting.roll_rad"));
}

TEST_CASE("a drive's messages become poses with the stamps of their scans, padded rows or not") {
  const HqslamNode node = node_with();
  const auto& odometry = rclcpp::Publisher<Odometry>::published;
  const Pose T_base_lidar(Eigen::Translation3d(kAheadOfBase_m, 0.0, 0.0));
  for (int i = 0; i < 6; ++i) {
    PointCloud2 message = as_sent(scan(i), {}, 0.1 * i);
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
    const Pose truth = T_base_lidar * hqslam::test::drive_pose(0.0).inverse() *
                       hqslam::test::drive_pose(0.1 * i) * T_base_lidar.inverse();
    const auto& found = odometry[static_cast<std::size_t>(i)];
    CHECK(std::abs(found.pose.pose.position.x - truth.translation().x()) < 0.05);
    CHECK(std::abs(found.pose.pose.position.y - truth.translation().y()) < 0.05);
    CHECK(rclcpp::Time(found.header.stamp).seconds() - kClock_s ==
          doctest::Approx(0.05 + 0.1 * i).epsilon(0.01));
    CHECK(found.header.frame_id == "odom");
    CHECK(found.child_frame_id == "base_link");
  }
  const Pose step = T_base_lidar * hqslam::test::drive_pose(0.4).inverse() *
                    hqslam::test::drive_pose(0.5) * T_base_lidar.inverse();
  const auto& twist = odometry.back().twist;
  CHECK((vector_of(twist.twist.linear) - 10.0 * step.translation()).norm() < 0.2);
  CHECK((vector_of(twist.twist.angular) - 10.0 * hqslam::logarithm(step).angular).norm() < 0.1);
  CHECK(twist.covariance[0] > 0.0);
  CHECK(odometry.back().pose.covariance[0] > 0.0);
  const auto& located = rclcpp::Publisher<Located>::published;
  REQUIRE(located.size() == 6);
  CHECK(located.back().header.frame_id == "map");
  CHECK(located.back().pose.pose.position.x ==
        doctest::Approx(odometry.back().pose.pose.position.x).epsilon(1e-6));
  CHECK(sent("odom", "base_link").translation().x() ==
        doctest::Approx(odometry.back().pose.pose.position.x));
  CHECK(sent("map", "odom").isApprox(Pose::Identity(), 1e-6));
}

TEST_CASE("until tf knows where the LiDAR is, scans are left out, and given it is published") {
  const HqslamNode asks = node_with();
  tf2_ros::Buffer::known.clear();
  take(as_sent(scan(0), {}, 0.0));
  CHECK(rclcpp::Publisher<Odometry>::published.empty());
  CHECK(rclcpp::Node::warnings.size() == 1);
  const HqslamNode given =
      node_with({{"lidar_in_base", std::vector<double>{0.0, 0.0, 2.0, 0.0, 0.0, 0.0}}});
  take(as_sent(scan(0), {}, 0.0));
  CHECK(rclcpp::Publisher<Odometry>::published.size() == 1);
  CHECK(sent("base_link", "lidar").translation().z() == doctest::Approx(2.0));
  CHECK_THROWS_AS(node_with({{"lidar_in_base", std::vector<double>{1.0}}}), hqslam::Error);
}

TEST_CASE("of an odom that comes from elsewhere map -> odom makes map's pose") {
  const HqslamNode node = node_with({{"publish_odom", false}});
  const Pose T_odom_base = hqslam::pose_from_xyz_rpy({100.0, 50.0, 0.0}, 0.0, 0.0, 0.7);
  take(as_sent(scan(0), {}, 0.0));
  CHECK(tf2_ros::TransformBroadcaster::sent.empty());  // tf does not know it yet
  tf2_ros::Buffer::known[{"odom", "base_link"}] = message_of(T_odom_base, {}, "base_link");
  take(as_sent(scan(1), {}, 0.1));
  REQUIRE(tf2_ros::TransformBroadcaster::sent.size() == 1);
  const Pose T_map_base = sent("map", "odom") * T_odom_base;
  const auto& position = rclcpp::Publisher<Located>::published.back().pose.pose.position;
  CHECK((T_map_base.translation() - vector_of(position)).norm() < 1e-9);
  const auto& stamp = tf2_ros::TransformBroadcaster::sent.back().header.stamp;
  CHECK(rclcpp::Time(stamp).seconds() - kClock_s == doctest::Approx(0.15 + 0.2).epsilon(0.01));
}

TEST_CASE("a scan waits for the inertial samples up to its end, or for the next scan") {
  const HqslamNode node = node_with();
  const auto& odometry = rclcpp::Publisher<Odometry>::published;
  rclcpp::Subscription<Imu>::publishers = 1;
  take(as_sent(scan(0), {}, 0.0));
  take(sample(0.05));
  CHECK(odometry.empty());
  take(sample(0.11));
  CHECK(odometry.size() == 1);
  take(as_sent(scan(1), {}, 0.1));
  take(as_sent(scan(2), {}, 0.2));
  CHECK(odometry.size() == 2);
}

TEST_CASE("a scan that cannot be used takes no other with it, whether scans wait or not") {
  for (const std::size_t imus : {0U, 1U}) {
    CAPTURE(imus);
    const HqslamNode node = node_with();
    rclcpp::Subscription<Imu>::publishers = imus;
    for (int i = 0; i < 6; ++i) {
      PointCloud2 message = as_sent(scan(i), {}, 0.1 * i);
      if (i == 1) put(message.data, 12, kClock_s + 100.0);  // a time of another scan
      take(message);
    }
    CHECK(rclcpp::Publisher<Odometry>::published.size() == 5 - imus);  // the last one waits
    CHECK(rclcpp::Node::warnings.size() == 1);
  }
}

TEST_CASE("inertial samples in a frame that tf does not know keep no scan waiting for tf") {
  const HqslamNode node = node_with();
  tf2_ros::Buffer::known.erase({"lidar", "imu"});
  rclcpp::Subscription<Imu>::publishers = 1;
  tf2_ros::Buffer::waited_s = 0.0;
  take(as_sent(scan(0), {}, 0.0));
  for (int i = 0; i < 10; ++i) take(sample(0.01 * i));
  CHECK(rclcpp::Node::warnings.size() == 10);
  CHECK(tf2_ros::Buffer::waited_s == 0.0);
}

TEST_CASE("the map is published now and then, and saved where it was said, in the frame of map") {
  const hqslam::test::TemporaryDirectory folder;
  const auto save = [] {
    const auto response = std::make_shared<Trigger::Response>();
    rclcpp::Service<Trigger>::callback(std::make_shared<Trigger::Request>(), response);
    return *response;
  };
  const HqslamNode refuses = node_with();
  CHECK_FALSE(save().success);
  const HqslamNode node = node_with({{"save_folder", folder.file("maps")}, {"map_period_s", 0.35}});
  CHECK_FALSE(save().success);  // no scan yet
  for (int i = 0; i < 6; ++i) take(as_sent(scan(i), {}, 0.1 * i));
  const auto& clouds = rclcpp::Publisher<PointCloud2>::published;
  REQUIRE(clouds.size() == 2);
  CHECK(clouds.back().header.frame_id == "map");
  CHECK(clouds.back().width > 100);
  const Trigger::Response saved = save();
  CAPTURE(saved.message);
  REQUIRE(saved.success);
  const hqslam::slam::SavedMap map = hqslam::slam::read_saved_map(saved.message);
  CHECK(map.places.front().T_map_sensor.translation().isApprox(
      Eigen::Vector3d(kAheadOfBase_m, 0.0, 1.2), 1e-6));
}

TEST_CASE("a message that is shorter than it says, or has no times, is left out and named") {
  const HqslamNode node = node_with();
  const PointCloud2 good = as_sent(scan(0), {}, 0.0);
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

}  // namespace hqslam_ros

// A ROS 2 node: points of a LiDAR with 16 beams in, pose and lifted points out.
//
//   subscribes  points             sensor_msgs/PointCloud2, fields x y z and t or time
//   publishes   odometry           nav_msgs/Odometry, sensor in the frame of the first scan, turned
//                                  level
//               lifted             sensor_msgs/PointCloud2, x y z of all rows
//               map -> sensor      by tf2
//   parameters  weights            a network of weights/, "" for none
//               sensor             a preset or .json file, without weights
//               map_frame, loop_closing, threads, and every name of `hqslam slam-options`, as
//               mounting.roll_rad
//
// Written against the documented interfaces of rclcpp and tf2_ros (Humble and later). Here, where
// there is no ROS, it is built and tested with stand-ins for them (tests/ros2).
#include <hqslam/core/error.h>
#include <hqslam/core/projection.h>
#include <hqslam/nn/upsampled_cloud.h>
#include <hqslam/slam/options.h>
#include <hqslam/slam/slam.h>
#include <tf2_ros/transform_broadcaster.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <geometry_msgs/msg/transform_stamped.hpp>
#include <memory>
#include <nav_msgs/msg/odometry.hpp>
#include <optional>
#include <rclcpp/rclcpp.hpp>
#include <sensor_msgs/msg/point_cloud2.hpp>
#include <sensor_msgs/point_cloud2_iterator.hpp>
#include <string>
#include <vector>

namespace {

using PointCloud2 = sensor_msgs::msg::PointCloud2;
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

/// Where each point of a message begins. Throws Error where the message is shorter than it says.
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

/// Points of a turn with their times, in seconds if they are floating-point numbers and else in
/// nanoseconds. Some drivers count them from the message's stamp, others write those of a clock,
/// which only a double can tell apart. Rows come from the elevation: drivers do not agree on
/// whether ring 0 is the highest beam or the lowest.
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
    times_s.push_back((seconds ? 1.0 : 1e-9) * number_at(message, *time, at));
    scan.points_m.emplace_back(number_at(message, *x, at), number_at(message, *y, at),
                               number_at(message, *z, at));
  }
  if (scan.points_m.empty()) throw hqslam::Error("a message without points");
  const auto [first_s, last_s] = std::minmax_element(times_s.begin(), times_s.end());
  const double middle_s = (*first_s + *last_s) / 2.0;
  for (const double time_s : times_s) {
    scan.time_offset_s.push_back(static_cast<float>(time_s - middle_s));
  }
  constexpr double kSmallestClock_s = 1e6;
  scan.stamp_s = middle_s;
  if (middle_s < kSmallestClock_s) scan.stamp_s += rclcpp::Time(message.header.stamp).seconds();
  return scan;
}

PointCloud2 message_of(const hqslam::OrganizedCloud& cloud, const std_msgs::msg::Header& header) {
  PointCloud2 message;
  message.header = header;
  sensor_msgs::PointCloud2Modifier modifier(message);
  modifier.setPointCloud2FieldsByString(1, "xyz");
  const auto returns = std::count_if(cloud.range_m.begin(), cloud.range_m.end(),
                                     [](float range_m) { return range_m > 0.0F; });
  modifier.resize(static_cast<std::size_t>(returns));
  sensor_msgs::PointCloud2Iterator<float> to(message, "x");
  for (std::size_t pixel = 0; pixel < cloud.range_m.size(); ++pixel) {
    if (!(cloud.range_m[pixel] > 0.0F)) continue;
    for (int axis = 0; axis < 3; ++axis) to[axis] = cloud.points_m[pixel][axis];
    ++to;
  }
  return message;
}

using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// hqslam's covariance is in the sensor's frame, the message's in that of the map. Of a pose of
/// which nothing is known it is infinite, whichever way one looks.
Matrix6 in_map(const Matrix6& covariance, const hqslam::Pose& T_map_sensor) {
  if (!covariance.allFinite()) return covariance;
  Matrix6 to_map = Matrix6::Zero();
  to_map.topLeftCorner<3, 3>() = to_map.bottomRightCorner<3, 3>() = T_map_sensor.linear();
  return to_map * covariance * to_map.transpose();
}

class HqslamNode : public rclcpp::Node {
 public:
  HqslamNode() : Node("hqslam"), broadcaster_(*this) {
    const std::string weights = declare_parameter("weights", "");
    const std::string sensor = declare_parameter("sensor", "os1-16");
    map_frame_ = declare_parameter("map_frame", "map");
    hqslam::slam::SlamOptions options;
    options.loop_closing.enabled = declare_parameter("loop_closing", false);
    options.threads = static_cast<int>(declare_parameter("threads", 0));
    for (const hqslam::slam::NamedOption& option : hqslam::slam::option_table()) {
      const std::string name(option.name);
      // A parameter takes values of the type that it is declared with.
      const double usual = option.get(options);
      const double value =
          option.is_whole
              ? static_cast<double>(declare_parameter(name, static_cast<std::int64_t>(usual)))
              : declare_parameter(name, usual);
      hqslam::slam::set_option(options, name, value);
    }
    if (weights.empty()) {
      sensor_ = hqslam::load_sensor(sensor);
    } else {
      upsampler_.emplace(hqslam::nn::SuperResolver::load(weights, {.threads = options.threads}));
      sensor_ = upsampler_->measured_sensor();
    }
    slam_.emplace(upsampler_ ? upsampler_->sensor() : sensor_, options);
    odometry_ = create_publisher<nav_msgs::msg::Odometry>("odometry", 10);
    lifted_ = create_publisher<PointCloud2>("lifted", rclcpp::SensorDataQoS());
    // One message waits: who is too slow loses whole scans.
    points_ = create_subscription<PointCloud2>(
        "points", rclcpp::SensorDataQoS().keep_last(1),
        [this](const PointCloud2::ConstSharedPtr& message) { take(*message); });
  }

 private:
  void take(const PointCloud2& message) {
    try {
      locate(message);
    } catch (const hqslam::Error& error) {
      RCLCPP_WARN_THROTTLE(get_logger(), *get_clock(), 1000, "scan left out: %s", error.what());
    }
  }

  void locate(const PointCloud2& message) {
    const hqslam::Scan scan = scan_of(message);
    hqslam::OrganizedCloud cloud = hqslam::project(scan, sensor_).cloud;
    if (upsampler_) cloud = hqslam::nn::upsampled_cloud(*upsampler_, cloud);
    const hqslam::slam::ScanReport report = slam_->process(cloud, scan.stamp_s);

    std_msgs::msg::Header header = message.header;
    header.stamp = rclcpp::Time(static_cast<std::int64_t>(1e9 * scan.stamp_s));
    if (upsampler_) lifted_->publish(message_of(cloud, header));
    publish(report, header);
  }

  void publish(const hqslam::slam::ScanReport& report, const std_msgs::msg::Header& header) {
    const Eigen::Vector3d position_m = report.T_map_sensor.translation();
    const Eigen::Quaterniond turn(report.T_map_sensor.rotation());
    geometry_msgs::msg::TransformStamped transform;
    transform.header.stamp = header.stamp;
    transform.header.frame_id = map_frame_;
    transform.child_frame_id = header.frame_id;
    transform.transform.translation.x = position_m.x();
    transform.transform.translation.y = position_m.y();
    transform.transform.translation.z = position_m.z();
    transform.transform.rotation.x = turn.x();
    transform.transform.rotation.y = turn.y();
    transform.transform.rotation.z = turn.z();
    transform.transform.rotation.w = turn.w();
    broadcaster_.sendTransform(transform);

    nav_msgs::msg::Odometry odometry;
    odometry.header = transform.header;
    odometry.child_frame_id = header.frame_id;
    odometry.pose.pose.position.x = position_m.x();
    odometry.pose.pose.position.y = position_m.y();
    odometry.pose.pose.position.z = position_m.z();
    odometry.pose.pose.orientation = transform.transform.rotation;
    const Matrix6 covariance = in_map(report.covariance, report.T_map_sensor);
    for (int row = 0; row < 6; ++row) {
      for (int column = 0; column < 6; ++column) {
        odometry.pose.covariance[static_cast<std::size_t>(6 * row + column)] =
            covariance(row, column);
      }
    }
    odometry_->publish(odometry);
  }

  std::string map_frame_;
  hqslam::SensorModel sensor_;  ///< of the points that come
  std::optional<hqslam::nn::Upsampler> upsampler_;
  std::optional<hqslam::slam::Slam> slam_;
  rclcpp::Publisher<nav_msgs::msg::Odometry>::SharedPtr odometry_;
  rclcpp::Publisher<PointCloud2>::SharedPtr lifted_;
  rclcpp::Subscription<PointCloud2>::SharedPtr points_;
  tf2_ros::TransformBroadcaster broadcaster_;
};

}  // namespace

int main(int argc, char** argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<HqslamNode>());
  rclcpp::shutdown();
  return 0;
}

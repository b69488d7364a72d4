// The node: points of a LiDAR in; where the robot is, the map and upsampled points out. README.md
// lists what it subscribes to and publishes, config/hqslam.yaml what its parameters mean.
//
// Here, where there is no ROS, it is built and tested with stand-ins for what it includes of it
// (tests/ros2).
#include <hqslam/core/error.h>
#include <hqslam/core/imu_sample.h>
#include <hqslam/pipeline/pipeline.h>
#include <hqslam/slam/options.h>
#include <hqslam/slam/saved_map.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <geometry_msgs/msg/pose_with_covariance_stamped.hpp>
#include <memory>
#include <nav_msgs/msg/odometry.hpp>
#include <optional>
#include <rcl_interfaces/msg/parameter_descriptor.hpp>
#include <rclcpp/rclcpp.hpp>
#include <rclcpp_components/register_node_macro.hpp>
#include <sensor_msgs/msg/imu.hpp>
#include <std_srvs/srv/trigger.hpp>
#include <string>
#include <utility>
#include <vector>

#include "frames.h"
#include "messages.h"
#include "point_cloud2.h"
// Humble has the first, Rolling warns of them.
#if __has_include(<tf2_ros/buffer.hpp>)
#include <tf2_ros/buffer.hpp>
#include <tf2_ros/static_transform_broadcaster.hpp>
#include <tf2_ros/transform_broadcaster.hpp>
#include <tf2_ros/transform_listener.hpp>
#else
#include <tf2_ros/buffer.h>
#include <tf2_ros/static_transform_broadcaster.h>
#include <tf2_ros/transform_broadcaster.h>
#include <tf2_ros/transform_listener.h>
#endif

namespace hqslam_ros {

namespace {

using hqslam::Pose;
using sensor_msgs::msg::Imu;
using std_srvs::srv::Trigger;

/// mounting.roll_rad and pitch_rad follow from where the LiDAR is on the robot.
bool is_parameter(const hqslam::slam::NamedOption& option) {
  return option.name != "mounting.roll_rad" && option.name != "mounting.pitch_rad";
}

}  // namespace

class HqslamNode : public rclcpp::Node {
 public:
  explicit HqslamNode(const rclcpp::NodeOptions& node_options)
      : Node("hqslam", node_options),
        buffer_(get_clock()),
        listener_(buffer_),
        broadcaster_(*this),
        static_broadcaster_(*this) {
    map_frame_ = parameter("map_frame", std::string("map"));
    odom_frame_ = parameter("odom_frame", std::string("odom"));
    base_frame_ = parameter("base_frame", std::string("base_link"));
    publish_odom_ = parameter("publish_odom", true);
    transform_tolerance_s_ = parameter("transform_tolerance_s", 0.2);
    map_period_s_ = parameter("map_period_s", 10.0);
    save_folder_ = parameter("save_folder", std::string());
    declare_sensor_on_robot();
    declare_slam();
    odometry_ = create_publisher<nav_msgs::msg::Odometry>("odometry", 10);
    pose_ = create_publisher<geometry_msgs::msg::PoseWithCovarianceStamped>("pose", 10);
    upsampled_ = create_publisher<PointCloud2>("upsampled", rclcpp::SensorDataQoS());
    map_points_ = create_publisher<PointCloud2>("map_points", rclcpp::QoS(1).transient_local());
    // One message waits: a node that is too slow loses whole scans.
    points_ = create_subscription<PointCloud2>(
        "points", rclcpp::SensorDataQoS().keep_last(1),
        [this](const PointCloud2::ConstSharedPtr& message) { warned([&] { take(*message); }); });
    imu_ = create_subscription<Imu>(
        "imu", rclcpp::SensorDataQoS().keep_last(1000),
        [this](const Imu::ConstSharedPtr& message) { warned([&] { take(*message); }); });
    save_map_ = create_service<Trigger>(
        "~/save_map", [this](std::shared_ptr<Trigger::Request>,
                             std::shared_ptr<Trigger::Response> response) { save_map(*response); });
  }

 private:
  struct WaitingScan {
    hqslam::Scan scan;
    double end_s = 0.0;
  };

  /// Read once: it is read-only later.
  template <typename Value>
  Value parameter(const std::string& name, const Value& usual, const std::string& meaning = "") {
    rcl_interfaces::msg::ParameterDescriptor descriptor;
    descriptor.description = meaning;
    descriptor.read_only = true;
    return declare_parameter(name, usual, descriptor);
  }

  void declare_sensor_on_robot() {
    const std::string name = "lidar_in_base";
    const std::vector<double> numbers = parameter(name, std::vector<double>());
    if (numbers.empty()) return;  // tf is asked for it
    if (numbers.size() != 6) {
      throw hqslam::Error(
          "{}: expected x y z in metres and roll pitch yaw in radians, found {} numbers", name,
          numbers.size());
    }
    T_base_lidar_ = hqslam::pose_from_xyz_rpy({numbers[0], numbers[1], numbers[2]}, numbers[3],
                                              numbers[4], numbers[5]);
  }

  void declare_slam() {
    const std::string weights = parameter("weights", std::string());
    const std::string sensor = parameter("sensor", std::string("os1-16"));
    const std::string map = parameter("map", std::string());
    hqslam::slam::SlamOptions& slam = options_.slam_options;
    slam.loop_closing.enabled = parameter("loop_closing", true);
    slam.threads = static_cast<int>(parameter("threads", std::int64_t{0}));
    for (const hqslam::slam::NamedOption& option : hqslam::slam::option_table()) {
      if (!is_parameter(option)) continue;
      const std::string name(option.name);
      // A parameter takes values of the type that it is declared with.
      const double usual = option.get(slam);
      const std::string meaning = std::string(option.meaning) + ": " + std::string(option.expected);
      const double value =
          option.is_whole
              ? static_cast<double>(parameter(name, static_cast<std::int64_t>(usual), meaning))
              : parameter(name, usual, meaning);
      hqslam::slam::set_option(slam, name, value);
    }
    hqslam::slam::validate(slam);
    if (!map.empty()) options_.map = hqslam::slam::read_saved_map(map);
    options_.upsampling.method = weights;
    options_.upsampling.network.threads = slam.threads;
    const hqslam::SensorModel named = hqslam::load_sensor(sensor);
    auto method = hqslam::pipeline::load_method(options_.upsampling, named);
    const auto made_for = hqslam::pipeline::sensor_of(method);
    upsampler_.emplace(made_for ? select_rows(*made_for, *made_for->measured_rows) : named,
                       std::move(method), options_.upsampling);
  }

  template <typename Work>
  void warned(const Work& work) {
    try {
      work();
    } catch (const hqslam::Error& error) {
      RCLCPP_WARN_THROTTLE(get_logger(), *get_clock(), 1000, "message left out: %s", error.what());
    }
  }

  /// Nothing, and a warning, where tf cannot transform in time; nothing else is done meanwhile.
  std::optional<Pose> looked_up(const std::string& target, const std::string& source,
                                const rclcpp::Time& time, double patience_s = 0.1) {
    try {
      return pose_of(buffer_.lookupTransform(target, source, time,
                                             rclcpp::Duration::from_seconds(patience_s)));
    } catch (const tf2::TransformException& error) {
      RCLCPP_WARN_THROTTLE(get_logger(), *get_clock(), 1000, "tf: %s", error.what());
      return std::nullopt;
    }
  }

  /// A scan waits for the inertial samples up to its end, if there are any, at most until the next.
  void take(const PointCloud2& message) {
    if (!pipeline_ && !begin(message.header.frame_id)) return;
    hqslam::Scan scan = scan_of(message);
    if (waiting_) warned([&] { process_waiting(); });  // whatever is wrong with it, this one waits
    float last_s = 0.0F;
    for (const float offset_s : scan.time_offset_s) last_s = std::max(last_s, offset_s);
    const double end_s = scan.stamp_s + last_s;
    waiting_ = WaitingScan{std::move(scan), end_s};
    if (imu_->get_publisher_count() == 0) process_waiting();
  }

  void take(const Imu& message) {
    if (!pipeline_) return;
    if (!R_lidar_imu_) {
      // Without patience: its messages come so often that scans would wait for tf all the time.
      const auto T_lidar_imu = looked_up(lidar_frame_, message.header.frame_id, time_of(0.0), 0.0);
      if (!T_lidar_imu) return;
      R_lidar_imu_ = T_lidar_imu->linear();
    }
    const double stamp_s = rclcpp::Time(message.header.stamp).seconds();
    pipeline_->add_imu({{stamp_s, *R_lidar_imu_ * vector_of(message.angular_velocity),
                         *R_lidar_imu_ * vector_of(message.linear_acceleration)}});
    if (waiting_ && stamp_s >= waiting_->end_s) process_waiting();
  }

  /// Makes the pipeline once the LiDAR's pose on the robot, and so its mounting, is known.
  bool begin(const std::string& lidar_frame) {
    lidar_frame_ = lidar_frame;
    if (T_base_lidar_) {
      static_broadcaster_.sendTransform(
          message_of(*T_base_lidar_, header_of(base_frame_, now().seconds()), lidar_frame_));
    } else {
      T_base_lidar_ = looked_up(base_frame_, lidar_frame_, time_of(0.0));
      if (!T_base_lidar_) return false;
    }
    const Eigen::Vector3d rpy_rad = hqslam::roll_pitch_yaw_rad(*T_base_lidar_);
    options_.slam_options.mounting.roll_rad = rpy_rad.x();
    options_.slam_options.mounting.pitch_rad = rpy_rad.y();
    pipeline_.emplace(std::move(*upsampler_), options_);
    frames_.emplace(*T_base_lidar_, options_.map.has_value());
    return true;
  }

  void process_waiting() {
    const hqslam::Scan scan = std::exchange(waiting_, std::nullopt)->scan;
    const hqslam::pipeline::LocatedScan located = pipeline_->process(scan);
    publish(frames_->next(located.report, pipeline_->trajectory()), located.report);
    const bool is_upsampled = pipeline_->upsampler().method() != nullptr;
    if (is_upsampled && upsampled_->get_subscription_count() > 0) {
      const Header header = header_of(lidar_frame_, scan.stamp_s);
      upsampled_->publish(message_of(hqslam::points_of(located.cloud), header));
    }
    publish_map(scan.stamp_s);
  }

  void publish(const RobotState& robot, const hqslam::slam::ScanReport& report) {
    const Header in_map = header_of(map_frame_, report.stamp_s);
    const Header in_odom = header_of(odom_frame_, report.stamp_s);
    std::optional<Pose> T_odom_base = robot.T_odom_base;
    if (publish_odom_) {
      broadcaster_.sendTransform(message_of(robot.T_odom_base, in_odom, base_frame_));
    } else {
      T_odom_base = looked_up(odom_frame_, base_frame_, time_of(report.stamp_s));
    }
    nav_msgs::msg::Odometry odometry;
    odometry.header = in_odom;
    odometry.child_frame_id = base_frame_;
    set(odometry.pose.pose.position, odometry.pose.pose.orientation, robot.T_odom_base);
    set(odometry.pose.covariance, robot.odom_covariance);
    set(odometry.twist.twist.linear, robot.velocity.linear);
    set(odometry.twist.twist.angular, robot.velocity.angular);
    set(odometry.twist.covariance, robot.velocity_covariance);
    odometry_->publish(odometry);

    if (report.mapping_status == hqslam::slam::Status::kNotRecognized) return;
    geometry_msgs::msg::PoseWithCovarianceStamped pose;
    pose.header = in_map;
    set(pose.pose.pose.position, pose.pose.pose.orientation, robot.T_map_base);
    set(pose.pose.covariance, robot.map_covariance);
    pose_->publish(pose);
    // Ahead, as it hardly changes: a lookup for now need not wait for the next scan.
    const Header ahead = header_of(map_frame_, report.stamp_s + transform_tolerance_s_);
    if (!T_odom_base) return;
    broadcaster_.sendTransform(
        message_of(T_map_odom(robot.T_map_base, *T_odom_base), ahead, odom_frame_));
  }

  /// The submap that the robot is in; a given map is sent once.
  void publish_map(double stamp_s) {
    const bool is_due = !map_sent_s_ || (!options_.map && stamp_s >= *map_sent_s_ + map_period_s_);
    if (!(map_period_s_ > 0.0) || !is_due) return;
    map_sent_s_ = stamp_s;
    std::vector<Eigen::Vector3f> points_m =
        pipeline_->map_points_m(pipeline_->submap_of_scan().back());
    const Eigen::Isometry3f T_map_slam = frames_->T_map_slam().cast<float>();
    for (Eigen::Vector3f& point_m : points_m) point_m = T_map_slam * point_m;
    map_points_->publish(message_of(points_m, header_of(map_frame_, stamp_s)));
  }

  void save_map(Trigger::Response& response) const {
    try {
      if (save_folder_.empty()) throw hqslam::Error("the parameter save_folder is empty");
      if (!pipeline_) throw hqslam::Error("no scan has come yet");
      const std::string path = std::filesystem::path(save_folder_) / "saved_map.npz";
      const hqslam::slam::SavedMap map = moved(pipeline_->saved_map(), frames_->T_map_slam());
      std::filesystem::create_directories(save_folder_);
      hqslam::slam::write_saved_map(path, map);
      response.success = true;
      response.message = path;
    } catch (const std::exception& error) {
      response.success = false;
      response.message = error.what();
    }
  }

  std::string map_frame_;
  std::string odom_frame_;
  std::string base_frame_;
  std::string lidar_frame_;
  bool publish_odom_ = true;
  double transform_tolerance_s_ = 0.0;
  double map_period_s_ = 0.0;
  std::string save_folder_;

  hqslam::pipeline::PipelineOptions options_;
  std::optional<hqslam::pipeline::Upsampler> upsampler_;  ///< until the pipeline has it
  std::optional<Pose> T_base_lidar_;
  std::optional<Eigen::Matrix3d> R_lidar_imu_;
  std::optional<hqslam::pipeline::Pipeline> pipeline_;
  std::optional<RobotFrames> frames_;
  std::optional<WaitingScan> waiting_;
  std::optional<double> map_sent_s_;

  tf2_ros::Buffer buffer_;
  tf2_ros::TransformListener listener_;
  tf2_ros::TransformBroadcaster broadcaster_;
  tf2_ros::StaticTransformBroadcaster static_broadcaster_;
  rclcpp::Publisher<nav_msgs::msg::Odometry>::SharedPtr odometry_;
  rclcpp::Publisher<geometry_msgs::msg::PoseWithCovarianceStamped>::SharedPtr pose_;
  rclcpp::Publisher<PointCloud2>::SharedPtr upsampled_;
  rclcpp::Publisher<PointCloud2>::SharedPtr map_points_;
  rclcpp::Subscription<PointCloud2>::SharedPtr points_;
  rclcpp::Subscription<Imu>::SharedPtr imu_;
  rclcpp::Service<Trigger>::SharedPtr save_map_;
};

}  // namespace hqslam_ros

RCLCPP_COMPONENTS_REGISTER_NODE(hqslam_ros::HqslamNode)

#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

// What the node uses of ROS, as far as its documentation and headers say what it does. Whatever is
// published, declared or warned of is kept.

namespace builtin_interfaces::msg {
struct Time {
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;
};
}  // namespace builtin_interfaces::msg

namespace std_msgs::msg {
struct Header {
  builtin_interfaces::msg::Time stamp;
  std::string frame_id;
};
}  // namespace std_msgs::msg

namespace geometry_msgs::msg {
struct Vector3 {
  double x = 0.0, y = 0.0, z = 0.0;
};
struct Quaternion {
  double x = 0.0, y = 0.0, z = 0.0, w = 1.0;
};
struct TransformStamped {
  std_msgs::msg::Header header;
  std::string child_frame_id;
  struct {
    Vector3 translation;
    Quaternion rotation;
  } transform;
};
struct Pose {
  Vector3 position;
  Quaternion orientation;
};
struct PoseWithCovariance {
  Pose pose;
  std::array<double, 36> covariance{};
};
struct PoseWithCovarianceStamped {
  std_msgs::msg::Header header;
  PoseWithCovariance pose;
};
}  // namespace geometry_msgs::msg

namespace nav_msgs::msg {
struct Odometry {
  std_msgs::msg::Header header;
  std::string child_frame_id;
  geometry_msgs::msg::PoseWithCovariance pose;
  struct {
    struct {
      geometry_msgs::msg::Vector3 linear;
      geometry_msgs::msg::Vector3 angular;
    } twist;
    std::array<double, 36> covariance{};
  } twist;
};
}  // namespace nav_msgs::msg

namespace sensor_msgs {
namespace msg {
struct PointField {
  enum : std::uint8_t { INT8 = 1, UINT8, INT16, UINT16, INT32, UINT32, FLOAT32, FLOAT64 };
  std::string name;
  std::uint32_t offset = 0;
  std::uint8_t datatype = 0;
  std::uint32_t count = 1;
};
struct PointCloud2 {
  using ConstSharedPtr = std::shared_ptr<const PointCloud2>;
  std_msgs::msg::Header header;
  std::uint32_t height = 1;
  std::uint32_t width = 0;
  std::vector<PointField> fields;
  std::uint32_t point_step = 0;
  std::uint32_t row_step = 0;
  std::vector<std::uint8_t> data;
};
struct Imu {
  using ConstSharedPtr = std::shared_ptr<const Imu>;
  std_msgs::msg::Header header;
  geometry_msgs::msg::Vector3 angular_velocity;
  geometry_msgs::msg::Vector3 linear_acceleration;
};
}  // namespace msg

class PointCloud2Modifier {
 public:
  explicit PointCloud2Modifier(msg::PointCloud2& message) : message_(message) {}
  void setPointCloud2FieldsByString(int /*count*/, const char* /*fields*/) {
    message_.point_step = 16;  // padded, as ROS does
  }
  void resize(std::size_t points) {
    message_.width = static_cast<std::uint32_t>(points);
    message_.data.resize(points * message_.point_step);
  }

 private:
  msg::PointCloud2& message_;
};

template <typename T>
class PointCloud2Iterator {
 public:
  PointCloud2Iterator(msg::PointCloud2& message, const std::string& /*first_field*/)
      : at_(message.data.data()), step_(message.point_step) {}
  T& operator[](int i) { return reinterpret_cast<T*>(at_)[i]; }
  void operator++() { at_ += step_; }

 private:
  std::uint8_t* at_;
  std::uint32_t step_;
};
}  // namespace sensor_msgs

namespace std_srvs::srv {
struct Trigger {
  struct Request {};
  struct Response {
    bool success = false;
    std::string message;
  };
};
}  // namespace std_srvs::srv

namespace rcl_interfaces::msg {
struct ParameterDescriptor {
  std::string description;
  bool read_only = false;
};
}  // namespace rcl_interfaces::msg

namespace rclcpp {
class Time {
 public:
  explicit Time(std::int64_t ns) : ns_(ns) {}
  Time(const builtin_interfaces::msg::Time& time)
      : ns_(1'000'000'000 * std::int64_t{time.sec} + time.nanosec) {}
  double seconds() const { return 1e-9 * static_cast<double>(ns_); }
  operator builtin_interfaces::msg::Time() const {
    return {static_cast<std::int32_t>(ns_ / 1'000'000'000),
            static_cast<std::uint32_t>(ns_ % 1'000'000'000)};
  }

 private:
  std::int64_t ns_;
};

struct Duration {
  static Duration from_seconds(double seconds) { return {seconds}; }
  double seconds = 0.0;
};

struct QoS {
  explicit QoS(std::size_t /*depth*/) {}
  QoS& transient_local() { return *this; }
};
struct SensorDataQoS {
  SensorDataQoS& keep_last(std::size_t /*depth*/) { return *this; }
};
struct NodeOptions {};

template <typename Message>
struct Publisher {
  using SharedPtr = std::shared_ptr<Publisher>;
  void publish(const Message& message) { published.push_back(message); }
  std::size_t get_subscription_count() const { return subscriptions; }
  static inline std::vector<Message> published;
  static inline std::size_t subscriptions = 1;
};

template <typename Message>
struct Subscription {
  using SharedPtr = std::shared_ptr<Subscription>;
  std::size_t get_publisher_count() const { return publishers; }
  static inline std::size_t publishers = 0;
  static inline std::function<void(const typename Message::ConstSharedPtr&)> callback;
};

template <typename ServiceType>
struct Service {
  using SharedPtr = std::shared_ptr<Service>;
  static inline std::function<void(std::shared_ptr<typename ServiceType::Request>,
                                   std::shared_ptr<typename ServiceType::Response>)>
      callback;
};

class Node {
 public:
  using Parameter = std::variant<bool, std::int64_t, double, std::string, std::vector<double>>;
  /// As the command line or a launch file gives them.
  static inline std::map<std::string, Parameter> given;
  static inline std::map<std::string, Parameter> declared;  ///< with their defaults
  static inline std::vector<std::string> warnings;

  Node(const std::string& /*name*/, const NodeOptions& /*options*/) { declared.clear(); }

  /// A value of another type than the parameter is declared with is refused.
  template <typename T>
  T declare_parameter(const std::string& name, const T& usual,
                      const rcl_interfaces::msg::ParameterDescriptor& /*descriptor*/) {
    declared[name] = usual;
    const auto found = given.find(name);
    if (found == given.end()) return usual;
    if (!std::holds_alternative<T>(found->second)) throw std::runtime_error(name);
    return std::get<T>(found->second);
  }
  template <typename Message, typename Quality>
  std::shared_ptr<Publisher<Message>> create_publisher(const std::string&, const Quality&) {
    return std::make_shared<Publisher<Message>>();
  }
  template <typename Message, typename Quality, typename Callback>
  std::shared_ptr<Subscription<Message>> create_subscription(const std::string&, const Quality&,
                                                             const Callback& callback) {
    Subscription<Message>::callback = callback;
    return std::make_shared<Subscription<Message>>();
  }
  template <typename ServiceType, typename Callback>
  std::shared_ptr<Service<ServiceType>> create_service(const std::string&,
                                                       const Callback& callback) {
    Service<ServiceType>::callback = callback;
    return std::make_shared<Service<ServiceType>>();
  }
  int get_logger() const { return 0; }
  const int* get_clock() const { return &clock_; }
  Time now() const { return Time(0); }

 private:
  int clock_ = 0;
};
}  // namespace rclcpp

#define RCLCPP_COMPONENTS_REGISTER_NODE(node)

#define RCLCPP_WARN_THROTTLE(logger, clock, ms, format, what) \
  ((void)(logger), (void)(clock), rclcpp::Node::warnings.push_back(what))

namespace tf2 {
struct TransformException : std::runtime_error {
  using std::runtime_error::runtime_error;
};
}  // namespace tf2

namespace tf2_ros {
/// Knows what it was told, at any time; what it was not, it waits for in vain.
struct Buffer {
  explicit Buffer(const int* /*clock*/) {}
  geometry_msgs::msg::TransformStamped lookupTransform(const std::string& target,
                                                       const std::string& source,
                                                       const rclcpp::Time& /*time*/,
                                                       const rclcpp::Duration& timeout) const {
    const auto found = known.find({target, source});
    if (found != known.end()) return found->second;
    waited_s += timeout.seconds;
    throw tf2::TransformException(target + " to " + source);
  }
  static inline std::map<std::pair<std::string, std::string>, geometry_msgs::msg::TransformStamped>
      known;
  static inline double waited_s = 0.0;
};
struct TransformListener {
  explicit TransformListener(Buffer& /*buffer*/) {}
};
struct TransformBroadcaster {
  explicit TransformBroadcaster(rclcpp::Node& /*node*/) {}
  void sendTransform(const geometry_msgs::msg::TransformStamped& transform) {
    sent.push_back(transform);
  }
  static inline std::vector<geometry_msgs::msg::TransformStamped> sent;
};
using StaticTransformBroadcaster = TransformBroadcaster;
}  // namespace tf2_ros

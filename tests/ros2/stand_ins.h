#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

// What the example of a ROS 2 node uses of ROS, as far as its documentation says what it does.
// Whatever is published or warned of is kept.

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
}  // namespace geometry_msgs::msg

namespace nav_msgs::msg {
struct Odometry {
  std_msgs::msg::Header header;
  std::string child_frame_id;
  struct {
    struct {
      geometry_msgs::msg::Vector3 position;
      geometry_msgs::msg::Quaternion orientation;
    } pose;
    std::array<double, 36> covariance{};
  } pose;
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

struct SensorDataQoS {
  SensorDataQoS& keep_last(std::size_t /*depth*/) { return *this; }
};

template <typename Message>
struct Publisher {
  using SharedPtr = std::shared_ptr<Publisher>;
  void publish(const Message& message) { published.push_back(message); }
  static inline std::vector<Message> published;
};

template <typename Message>
struct Subscription {
  using SharedPtr = std::shared_ptr<Subscription>;
  static inline std::function<void(const typename Message::ConstSharedPtr&)> callback;
};

class Node {
 public:
  /// As the command line or a launch file gives them.
  static inline std::map<std::string, std::variant<bool, std::int64_t, double, std::string>> given;
  static inline std::vector<std::string> warnings;

  explicit Node(const std::string& /*name*/) {}

  /// A value of another type than the parameter is declared with is refused.
  template <typename T>
  auto declare_parameter(const std::string& name, const T& usual) {
    using Stored = std::conditional_t<
        std::is_same_v<T, bool>, bool,
        std::conditional_t<std::is_integral_v<T>, std::int64_t,
                           std::conditional_t<std::is_floating_point_v<T>, double, std::string>>>;
    const auto found = given.find(name);
    if (found == given.end()) return Stored(usual);
    if (!std::holds_alternative<Stored>(found->second)) throw std::runtime_error(name);
    return std::get<Stored>(found->second);
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
  int get_logger() const { return 0; }
  const int* get_clock() const { return &clock_; }

 private:
  int clock_ = 0;
};

inline void init(int /*argc*/, char** /*argv*/) {}
inline void spin(const std::shared_ptr<Node>& /*node*/) {}
inline void shutdown() {}
}  // namespace rclcpp

#define RCLCPP_WARN_THROTTLE(logger, clock, ms, format, what) \
  ((void)(logger), (void)(clock), rclcpp::Node::warnings.push_back(what))

namespace tf2_ros {
class TransformBroadcaster {
 public:
  explicit TransformBroadcaster(rclcpp::Node& /*node*/) {}
  void sendTransform(const geometry_msgs::msg::TransformStamped& transform) {
    sent.push_back(transform);
  }
  static inline std::vector<geometry_msgs::msg::TransformStamped> sent;
};
}  // namespace tf2_ros


#include "bags.h"

namespace hqslam::test {
namespace {

/// Writes a message as ROS 2 (CDR, little-endian) or ROS 1 does.
class Writer {
 public:
  explicit Writer(bool ros1) : ros1_(ros1) {
    if (!ros1) bytes = {0, 1, 0, 0};  // little-endian CDR
  }
  template <typename T>
  void number(T value) {
    while (!ros1_ && (bytes.size() - 4) % sizeof(T) != 0) bytes.push_back(0);
    const auto* first = reinterpret_cast<const std::uint8_t*>(&value);
    for (std::size_t i = 0; i < sizeof(T); ++i) bytes.push_back(first[i]);
  }
  void words(const std::string& text) {
    number(static_cast<std::uint32_t>(text.size() + (ros1_ ? 0 : 1)));
    bytes.insert(bytes.end(), text.begin(), text.end());
    if (!ros1_) bytes.push_back(0);
  }
  void raw(const Payload& payload) { bytes.insert(bytes.end(), payload.begin(), payload.end()); }
  void time(std::int64_t ns) {
    number(static_cast<std::uint32_t>(ns / 1'000'000'000));
    number(static_cast<std::uint32_t>(ns % 1'000'000'000));
  }
  void header(std::int64_t ns, const std::string& frame = "lidar") {
    if (ros1_) number(std::uint32_t{0});
    time(ns);
    words(frame);
  }
  Payload bytes;

 private:
  bool ros1_;
};

/// space_bytes: in which every packet stands, its length behind it; 0: as it is.
Payload scan_message(const std::vector<Captured>& packets, bool ros1, std::size_t space_bytes) {
  Writer writer(ros1);
  writer.header(packets.front().time_ns);
  writer.number(static_cast<std::uint32_t>(packets.size()));
  for (Captured packet : packets) {
    const auto bytes = static_cast<std::uint32_t>(packet.payload.size());
    if (space_bytes > 0) packet.payload.resize(space_bytes);
    writer.time(packet.time_ns);
    writer.raw(packet.payload);
    if (space_bytes > 0) writer.number(bytes);
  }
  return writer.bytes;
}

}  // namespace

Payload velodyne_scan_message(const std::vector<Captured>& packets, bool ros1) {
  return scan_message(packets, ros1, 0);
}

Payload pandar_scan_message(const std::vector<Captured>& packets, bool ros1) {
  return scan_message(packets, ros1, 1500);
}

std::vector<BagMessage> scan_messages(const std::string& topic, const std::string& type,
                                      const std::vector<Captured>& packets, std::size_t each,
                                      bool ros1,
                                      Payload (*message)(const std::vector<Captured>&, bool)) {
  std::vector<BagMessage> messages;
  for (std::size_t i = 0; i + each <= packets.size(); i += each) {
    const auto first = packets.begin() + static_cast<std::ptrdiff_t>(i);
    const std::vector<Captured> part(first, first + static_cast<std::ptrdiff_t>(each));
    messages.push_back({topic, type, part.front().time_ns, message(part, ros1)});
  }
  return messages;
}

Payload buffer_message(const Payload& packet, bool ros1) {
  Writer writer(ros1);
  writer.number(static_cast<std::uint32_t>(packet.size()));
  writer.raw(packet);
  return writer.bytes;
}

Payload text_message(const std::string& text, bool ros1) {
  Writer writer(ros1);
  writer.words(text);
  return writer.bytes;
}

std::vector<CloudPoint> round_cloud(double period_s, double unit_s, double zero_s) {
  std::vector<CloudPoint> points;
  for (int column = 0; column < 360; ++column) {
    for (int ring = 0; ring < 16; ++ring) {
      const double azimuth = -column * std::numbers::pi / 180.0;
      const double elevation = (-15.0 + 2.0 * ring) * std::numbers::pi / 180.0;
      points.push_back({static_cast<float>(5.0 * std::cos(elevation) * std::cos(azimuth)),
                        static_cast<float>(5.0 * std::cos(elevation) * std::sin(azimuth)),
                        static_cast<float>(5.0 * std::sin(elevation)),
                        static_cast<std::uint16_t>(ring),
                        (zero_s + period_s * column / 360.0) / unit_s});
    }
  }
  return points;
}

Payload cloud_message(std::int64_t stamp_ns, const std::vector<CloudPoint>& points, bool ros1,
                      std::uint8_t time_type, const std::string& time_name,
                      const std::string& ring_name) {
  Writer writer(ros1);
  writer.header(stamp_ns);
  writer.number(std::uint32_t{1});
  writer.number(static_cast<std::uint32_t>(points.size()));
  writer.number(std::uint32_t{5});
  const std::uint32_t step = 26;
  const auto field = [&](const std::string& name, std::uint32_t offset, std::uint8_t type) {
    writer.words(name);
    writer.number(offset);
    writer.number(type);
    writer.number(std::uint32_t{1});
  };
  field("x", 0, 7);
  field("y", 4, 7);
  field("z", 8, 7);
  field(ring_name, 12, 4);
  field(time_name, 18, time_type);
  writer.number(std::uint8_t{0});
  writer.number(step);
  writer.number(static_cast<std::uint32_t>(step * points.size()));
  writer.number(static_cast<std::uint32_t>(step * points.size()));
  // No two scans of a real sensor are the same.
  const float scale = 1.0F + 2e-7F * static_cast<float>(stamp_ns / 1'000'000 % 37);
  for (CloudPoint point : points) {
    for (float* const coordinate : {&point.x, &point.y, &point.z}) *coordinate *= scale;
    Payload bytes(step);
    std::memcpy(bytes.data(), &point.x, 4);
    std::memcpy(bytes.data() + 4, &point.y, 4);
    std::memcpy(bytes.data() + 8, &point.z, 4);
    std::memcpy(bytes.data() + 12, &point.ring, 2);
    const auto single = static_cast<float>(point.time);
    if (time_type == 6) put(bytes, 18, static_cast<std::uint32_t>(point.time));
    if (time_type == 7) std::memcpy(bytes.data() + 18, &single, 4);
    if (time_type == 8) std::memcpy(bytes.data() + 18, &point.time, 8);
    writer.raw(bytes);
  }
  writer.number(std::uint8_t{1});
  return writer.bytes;
}

Payload imu_message(std::int64_t stamp_ns, const std::string& frame, const ImuSample& sample,
                    bool ros1, double first_covariance) {
  Writer writer(ros1);
  writer.header(stamp_ns, frame);
  for (int i = 0; i < 4 + 9; ++i) writer.number(i == 3 ? 1.0 : 0.0);
  for (const auto& vector : {sample.angular_rate_rad_per_s, sample.specific_force_mps2}) {
    for (int i = 0; i < 3; ++i) writer.number(vector[i]);
    for (int i = 0; i < 9; ++i) writer.number(i == 0 ? first_covariance : 0.0);
  }
  return writer.bytes;
}

Payload transform_message(const std::string& parent, const std::string& child,
                          const Eigen::Quaterniond& q_parent_child, bool ros1) {
  Writer writer(ros1);
  writer.number(std::uint32_t{1});
  writer.header(0, parent);
  writer.words(child);
  for (const double metres : {1.0, 2.0, 3.0}) writer.number(metres);
  const auto& q = q_parent_child;
  for (const double number : {q.x(), q.y(), q.z(), q.w()}) writer.number(number);
  return writer.bytes;
}

}  // namespace hqslam::test

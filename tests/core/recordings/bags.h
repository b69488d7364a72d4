#pragma once

#include <Eigen/Geometry>

#include "captures.h"

namespace hqslam::test {

/// One message of a bag that a test makes.
struct BagMessage {
  std::string topic;
  std::string type;  ///< as ROS 2 writes it, with /msg/
  std::int64_t time_ns = 0;
  Payload bytes;
};

/// A velodyne_msgs/VelodyneScan with these packets.
Payload velodyne_scan_message(const std::vector<Captured>& packets, bool ros1);
/// A pandar_msgs/PandarScan with these packets.
Payload pandar_scan_message(const std::vector<Captured>& packets, bool ros1);
/// Messages of a topic with this many packets each; an incomplete last one is left out.
std::vector<BagMessage> scan_messages(const std::string& topic, const std::string& type,
                                      const std::vector<Captured>& packets, std::size_t each,
                                      bool ros1,
                                      Payload (*message)(const std::vector<Captured>&,
                                                         bool) = velodyne_scan_message);
/// A message of one buffer: Ouster's PacketMsg.
Payload buffer_message(const Payload& packet, bool ros1);
/// A std_msgs/String.
Payload text_message(const std::string& text, bool ros1);

/// A point of a cloud with a ring and a time.
struct CloudPoint {
  float x = 0.0F, y = 0.0F, z = 0.0F;
  std::uint16_t ring = 0;
  double time = 0.0;
};
/// One turn of a VLP-16 in a round room of 5 m, from the front on; times in `unit_s` from `zero_s`.
std::vector<CloudPoint> round_cloud(double period_s, double unit_s = 1.0, double zero_s = 0.0);
/// A sensor_msgs/PointCloud2; its field of times has this type (6: uint32, 7: float32, 8: float64).
Payload cloud_message(std::int64_t stamp_ns, const std::vector<CloudPoint>& points, bool ros1,
                      std::uint8_t time_type = 8, const std::string& time_name = "timestamp",
                      const std::string& ring_name = "ring");

/// A sensor_msgs/Imu in this frame.
Payload imu_message(std::int64_t stamp_ns, const std::string& frame, const ImuSample& sample,
                    bool ros1, double first_covariance = 0.0);
/// A tf2_msgs/TFMessage: how a frame is turned in its parent.
Payload transform_message(const std::string& parent, const std::string& child,
                          const Eigen::Quaterniond& q_parent_child, bool ros1);

/// The bytes of an MCAP file; compression "", "lz4" or "zstd".
std::string mcap_bytes(const std::vector<BagMessage>& messages, const std::string& compression);
/// The bytes of a ROS 1 bag; compression "none", "lz4" or "bz2". Messages are written by ROS 1.
std::string ros1_bytes(const std::vector<BagMessage>& messages, const std::string& compression);
/// Writes a ROS 2 bag (sqlite), whose topics say to be serialized so.
void write_db3(const std::vector<BagMessage>& messages, const std::string& path,
               const std::string& serialization_format = "cdr");
/// Writes one whose messages are a view that never ends.
void write_endless_db3(const std::string& path);
/// A copy of such a bag as it is on disk while it is written: in write-ahead mode, and that the
/// second half of the messages was deleted is only in the log beside it.
void copy_with_half_taken_back(const std::string& path, const std::string& copy);

}  // namespace hqslam::test

#pragma once

#include "bags.h"
#include "hqslam/recordings/recording.h"

// Bags of a VLP-16, of its packets or clouds.
namespace hqslam::test {

inline constexpr const char* kCloudType = "sensor_msgs/msg/PointCloud2";

/// A VLP-16's packets as messages of ten packets.
inline std::vector<BagMessage> velodyne_messages(bool ros1) {
  auto messages = scan_messages("/velodyne_packets", "velodyne_msgs/msg/VelodyneScan",
                                velodyne_capture({.duration_s = 0.45}), 10, ros1);
  messages.insert(messages.begin() + 1, {"/other", "std_msgs/msg/String", messages[0].time_ns,
                                         text_message("nothing", ros1)});
  return messages;
}

/// How a driver writes the points of a turn.
struct CloudForm {
  const char* ring = "ring";
  const char* time = "timestamp";
  std::uint8_t type = 7;
  double unit_s = 1.0;
  std::optional<double> clock_s = std::nullopt;  ///< of the first turn; none: each begins at 0
  double period_s = 0.1;
  bool highest_first = false;
  bool with_nan = false;
};

/// Five clouds, the fourth of which never came.
inline std::vector<BagMessage> cloud_messages(const CloudForm& form = {}) {
  std::vector<BagMessage> messages;
  for (const int i : {0, 1, 2, 4}) {
    const double since_s = form.period_s * i;
    const auto begin_ns = static_cast<std::int64_t>(1e9 * (1'600'000'000.0 + since_s));
    auto points =
        round_cloud(form.period_s, form.unit_s, form.clock_s ? *form.clock_s + since_s : 0.0);
    for (CloudPoint& point : points) {
      if (form.with_nan && point.ring == 3 && point.x > 4.0F) point.x = std::nanf("");
      if (form.highest_first) point.ring = static_cast<std::uint16_t>(15 - point.ring);
    }
    messages.push_back({"/points", kCloudType, begin_ns + 5'000'000,
                        cloud_message(begin_ns, points, false, form.type, form.time, form.ring)});
  }
  return messages;
}

/// These messages in a folder of their own.
struct Bag {
  TemporaryDirectory folder;
  std::string path = folder.file("a.mcap");

  explicit Bag(const std::vector<BagMessage>& messages) {
    write_file(path, mcap_bytes(messages, "zstd"));
  }
  recordings::Recording open(const recordings::OpenOptions& options = {.sensor = "vlp-16"}) const {
    return recordings::Recording::open(path, options);
  }
};

inline std::vector<RecordedScan> scans_of(const std::vector<BagMessage>& messages,
                                          const recordings::OpenOptions& options = {}) {
  const Bag bag(messages);
  return all_scans(bag.open(options));
}

}  // namespace hqslam::test

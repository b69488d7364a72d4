#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "recording_file.h"

namespace hqslam::recordings {

/// What the messages of a bag's file that name this number are.
struct Topic {
  std::string name;
  std::string type;  ///< "sensor_msgs/msg/PointCloud2"; ROS 1's "sensor_msgs/PointCloud2"
};

/// One file of a bag.
class BagFile {
 public:
  virtual ~BagFile() = default;
  /// The next message, or nothing at the end, be it that of the file or of what was written of it;
  /// its `stream` is the number of its topic. Throws Error for a damaged file.
  virtual std::optional<Message> next() = 0;
  /// Those that were met so far.
  const std::map<std::uint32_t, Topic>& topics() const { return topics_; }
  /// As RecordingFile's.
  virtual void keep_only(const std::string& /*topic*/) {}
  virtual double read_share() const = 0;

 protected:
  std::map<std::uint32_t, Topic> topics_;
};

/// Bytes that no single message or chunk of a sensor's recording reaches; a file that claims more
/// is damaged.
inline constexpr std::size_t kMaxChunkBytes = std::size_t{1} << 29U;

/// ROS 2's sqlite form. Throws Error.
std::unique_ptr<BagFile> open_db3(const std::string& path);
/// MCAP, chunks stored or compressed by lz4 or zstd. A file that was cut off ends where it was cut.
/// Source: MCAP format specification, version 0. Throws Error.
std::unique_ptr<BagFile> open_mcap(const std::string& path);
/// ROS 1's form (version 2.0), chunks stored or compressed by bz2 or lz4. Throws Error.
std::unique_ptr<BagFile> open_ros1_bag(const std::string& path);

using OpenBagFile = std::unique_ptr<BagFile> (*)(const std::string& path);

/// A bag of one file or more of a kind, one after the other: its topics are streams. Throws Error.
std::unique_ptr<RecordingFile> bag_recording(std::vector<std::string> paths, std::string kind,
                                             OpenBagFile open);

}  // namespace hqslam::recordings

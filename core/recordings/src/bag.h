#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "recording_file.h"

namespace hqslam::recordings {

/// A topic of a bag.
struct Topic {
  std::string name;  ///< as the bag has it
  std::string type;  ///< "sensor_msgs/msg/PointCloud2"; ROS 1's "sensor_msgs/PointCloud2"
  std::int64_t messages = 0;
};

/// The messages of a bag, topic by topic.
class Bag {
 public:
  virtual ~Bag() = default;
  virtual std::string kind() const = 0;
  virtual const std::vector<Topic>& topics() const = 0;
  virtual std::unique_ptr<MessageSource> messages(const std::string& topic) const = 0;
};

/// Adds a topic to a list, or its messages to those of the same name.
void add_topic(std::vector<Topic>& topics, const Topic& topic);

/// Bytes that no single message or chunk of a sensor's recording reaches; a file that claims more
/// is damaged.
inline constexpr std::size_t kMaxChunkBytes = std::size_t{1} << 29U;

/// ROS 2's sqlite form. Throws Error.
std::unique_ptr<Bag> open_db3(const std::string& path);
/// MCAP, chunks stored or compressed by lz4 or zstd. A file that was cut off ends where it was cut.
/// Source: MCAP format specification, version 0. Throws Error.
std::unique_ptr<Bag> open_mcap(const std::string& path);
/// ROS 1's form (version 2.0), chunks stored or compressed by bz2 or lz4. Throws Error.
std::unique_ptr<Bag> open_ros1_bag(const std::string& path);
/// A bag in several files, one after the other.
std::unique_ptr<Bag> chained(std::vector<std::unique_ptr<Bag>> bags);

/// A bag as a recording: its topics with packets and point clouds are streams.
std::unique_ptr<RecordingFile> bag_recording(std::unique_ptr<Bag> bag, const std::string& path);

/// Of the name of a topic, a type or a field in a message.
inline constexpr std::size_t kNameCharacters = 200;

}  // namespace hqslam::recordings

#pragma once

#include <cstdint>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "byte_reader.h"
#include "recording_file.h"

namespace hqslam::recordings {

/// What the messages of a bag's file that name this number are.
struct Topic {
  std::string name;
  std::string type;  ///< "sensor_msgs/msg/PointCloud2"; ROS 1's "sensor_msgs/PointCloud2"
};
/// Of the name of a topic or a type as it stands in a file; a topic with a longer one is passed
/// over.
inline constexpr std::size_t kMaxNameBytes = 1000;

/// One file of a bag.
class BagFile {
 public:
  virtual ~BagFile() = default;
  /// The next message, or nothing at the end, be it that of the file or of what was written of it;
  /// its `stream` is the number of its topic. Throws Error for a damaged file.
  virtual std::optional<Message> next() = 0;
  /// The topics of the messages read so far.
  const std::map<std::uint32_t, Topic>& topics() const { return topics_; }
  /// RecordingFile::keep_only().
  virtual void keep_only(const std::vector<std::string>& /*topics*/) {}
  virtual double read_share() const = 0;
  /// RecordingFile::missing().
  virtual std::string missing() const { return ""; }

 protected:
  void add_topic(std::uint32_t id, Topic topic);

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

/// Whether a message was compressed by itself (rosbag2's compression mode "message"): no message of
/// ROS begins as zstd's frames do.
bool is_packed(Bytes message);
/// Its content; empty for a damaged one.
std::vector<std::uint8_t> unpacked_message(Bytes message);

using OpenBagFile = std::unique_ptr<BagFile> (*)(const std::string& path);

/// A bag's file, record by record; records may be packed in chunks.
class ScannedBag : public BagFile {
 public:
  /// Records stand between the file's first bytes and its last ones; `repair` ends the messages
  /// about damage.
  ScannedBag(const std::string& path, std::uint64_t first_bytes, std::uint64_t last_bytes,
             std::string repair);
  std::optional<Message> next() override;
  double read_share() const override;
  /// Names a file that ends within a record.
  std::string missing() const override;

 protected:
  /// Sets `message` if the record is one; false at the end. Throws Error, with no file's name in
  /// it.
  virtual bool read_record(std::optional<Message>& message) = 0;

  /// The next bytes of the chunk that is open, else of the file; false at the file's end, and
  /// nothing is read of what a damaged length claims beyond it. They live until the next call,
  /// those of a chunk until the next chunk.
  bool read(std::uint64_t count, Bytes& bytes);
  bool skip(std::uint64_t count);
  /// What comes next is the records in these bytes. A chunk in a chunk is passed over.
  void open_chunk(Bytes packed, const std::string& compression, std::uint64_t size);

 private:
  std::string path_;
  std::string repair_;
  std::uint64_t last_bytes_ = 0;
  std::ifstream stream_;
  std::uint64_t bytes_ = 0;  ///< of the file
  std::uint64_t left_ = 0;   ///< of these
  std::vector<std::uint8_t> buffer_;
  std::vector<std::uint8_t> chunk_;
  Bytes left_of_chunk_;
  bool in_chunk_ = false;
  bool is_cut_off_ = false;
};

}  // namespace hqslam::recordings

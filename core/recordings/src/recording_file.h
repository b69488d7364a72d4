#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "byte_reader.h"
#include "hqslam/recordings/recording.h"

namespace hqslam::recordings {

/// One message of a bag, or the payload of one packet of a capture.
struct Message {
  std::int64_t time_ns = 0;  ///< when it was recorded, since 1970
  Bytes bytes;               ///< live until the next message is asked for
  bool ros1 = false;         ///< how it is written: ROS 1's own way, or ROS 2's CDR
  std::size_t stream = 0;    ///< index into RecordingFile::streams()
};

/// A capture or a bag, read once, from its beginning to its end.
class RecordingFile {
 public:
  virtual ~RecordingFile() = default;
  /// "pcap capture", "ROS 2 bag (sqlite)", ...
  virtual std::string kind() const = 0;
  /// The streams of the messages read so far.
  const std::vector<Stream>& streams() const { return streams_; }
  /// The next message of any stream, or nothing at the end. Throws Error for a file that cannot be
  /// read on.
  virtual std::optional<Message> next() = 0;
  /// Messages of other streams need not be read from here on.
  virtual void keep_only(const std::vector<std::size_t>& /*streams*/) {}
  /// How much of the file was read, 0 to 1.
  virtual double read_share() const = 0;
  /// What was left out, once all was read: "" or one line.
  virtual std::string complaint() const { return ""; }
  /// What should follow and does not, once all was read: "" or one line.
  virtual std::string missing() const { return ""; }

 protected:
  std::vector<Stream> streams_;
};

/// Opens a capture or a bag by its first bytes. Throws Error, also for other files and folders.
std::unique_ptr<RecordingFile> open_recording_file(const std::string& path);

/// A capture, each stream what one sender sends to one port. Throws Error.
std::unique_ptr<RecordingFile> open_pcap_recording(const std::string& path);

/// Longest excerpt of the name of a topic, a type or a field in a message.
inline constexpr std::size_t kNameCharacters = 200;

}  // namespace hqslam::recordings

#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hqslam/recordings/packet.h"
#include "hqslam/recordings/recording.h"

namespace hqslam::recordings {

/// One message of a bag.
struct Message {
  std::int64_t time_ns = 0;  ///< when it was recorded, since 1970
  std::span<const std::uint8_t> bytes;
  bool ros1 = false;  ///< how it is written: ROS 1's own way, or ROS 2's CDR
};

/// Messages of one topic in the order in which they were recorded.
class MessageSource {
 public:
  virtual ~MessageSource() = default;
  /// The next message, or nothing at the end; its bytes live until the next call. Throws Error for
  /// a file that cannot be read on.
  virtual std::optional<Message> next() = 0;
};

/// A capture or a bag, and what is in it.
class RecordingFile {
 public:
  virtual ~RecordingFile() = default;
  /// "pcap capture", "ROS 2 bag (sqlite)", ...
  virtual std::string kind() const = 0;
  virtual const std::vector<Stream>& streams() const = 0;
  /// The packets of a stream of packets.
  virtual std::unique_ptr<PacketSource> packets(const Stream& stream) const = 0;
  /// The messages of a stream of a bag. Throws Error for a capture.
  virtual std::unique_ptr<MessageSource> messages(const Stream& stream) const = 0;
  /// An Ouster's metadata, if the file holds them for this stream; "" otherwise.
  virtual std::string ouster_metadata(const Stream& /*stream*/) const { return ""; }
};

/// Opens a capture or a bag by its first bytes; nothing for other files and folders. Throws Error.
std::unique_ptr<RecordingFile> open_recording_file(const std::string& path);

std::unique_ptr<RecordingFile> open_pcap_recording(const std::string& path);

}  // namespace hqslam::recordings

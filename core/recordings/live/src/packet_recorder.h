#pragma once

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "live_stream.h"
#include "pcap_writer.h"

namespace hqslam::live {

/// Records the sensor's packets from its recognition on, with those kept before. A full disk ends
/// the recording, not the drive.
class PacketRecorder {
 public:
  /// As LiveOptions::record. Throws Error as PcapWriter does.
  explicit PacketRecorder(const std::string& path);

  /// Keeps a packet until it is known whether its sender is the sensor; the oldest make room.
  void keep(const recordings::Packet& packet);
  /// The sensor is recognized: records its packets so far, after its metadata, without which they
  /// cannot be read.
  void begin(const LiveStream& stream);
  void add(const recordings::Packet& packet);
  /// Why recording has ended; "": it has not.
  const std::string& failure() const { return failure_; }

 private:
  struct Kept {
    recordings::Packet packet;
    std::vector<std::uint8_t> payload;
  };

  /// write(writer), as long as the disk takes it.
  template <typename Write>
  void record(const Write& write);

  std::optional<PcapWriter> writer_;
  std::deque<Kept> kept_;
  std::size_t kept_bytes_ = 0;
  std::string failure_;
};

}  // namespace hqslam::live

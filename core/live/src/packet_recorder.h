#pragma once

#include <cstdint>
#include <cstdio>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hqslam/recordings/packet.h"
#include "live_stream.h"

namespace hqslam::live {

/// Writes UDP datagrams into a .pcap file (nanoseconds, raw IP) that open_pcap reads back: their
/// sender, port, payload and time. Source: libpcap, "pcap-savefile". The receiver's address and the
/// sender's port are not known and stand as 255.255.255.255 (or ff02::1) and as the receiver's
/// port.
class PcapWriter {
 public:
  /// Throws Error if it is not called .pcap, if there is such a file already, or one with .json in
  /// its place, or if it cannot be written.
  explicit PcapWriter(const std::string& path);
  /// Removes the file if it holds no packet: its name is free again for the next attempt.
  ~PcapWriter();
  PcapWriter(const PcapWriter&) = delete;
  PcapWriter& operator=(const PcapWriter&) = delete;

  /// Throws Error if the disk is full.
  void add(const recordings::Packet& packet);
  /// Writes an Ouster's metadata where open_recording looks for them: the same name with .json.
  /// Throws Error.
  void put_beside(const std::string& metadata) const;

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  void write(const void* bytes, std::size_t count);

  std::string path_;
  std::unique_ptr<std::FILE, Close> file_;
  std::vector<std::uint8_t> frame_;
  bool has_packets_ = false;
};

/// Records what the sensor sends, as soon as it is known who it is. A full disk ends the recording,
/// not the drive.
class PacketRecorder {
 public:
  /// As LiveOptions::record. Throws Error as PcapWriter does.
  explicit PacketRecorder(const std::string& path);

  /// Keeps a packet until it is known whether its sender is the sensor; the oldest make room.
  void keep(const recordings::Packet& packet);
  /// The sensor is recognised: records what it has sent up to now, its metadata first, without
  /// which the packets say nothing.
  void begin(const LiveStream& stream);
  void add(const recordings::Packet& packet);
  /// Why no more packets are recorded; "": they are.
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

#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "hqslam/recordings/packet.h"

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
  /// Writes an Ouster's metadata where Recording::open finds them: the same name with .json.
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

}  // namespace hqslam::live

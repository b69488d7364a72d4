#include "pcap_writer.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "byte_reader.h"
#include "hqslam/core/error.h"

namespace hqslam::live {

using namespace recordings;

namespace {

constexpr std::uint32_t kMaxFrame = 65535 + 40;
constexpr std::size_t kUdpHeader = 8;
constexpr std::uint8_t kUdp = 17;
constexpr std::uint8_t kMostHops = 64;

using Frame = std::vector<std::uint8_t>;

void put_big_endian(Frame& frame, std::size_t at, std::size_t value) {
  frame[at] = static_cast<std::uint8_t>(value >> 8);
  frame[at + 1] = static_cast<std::uint8_t>(value);
}

/// The internet checksum of the bytes from `begin` on, with what is added already. Source: RFC
/// 1071.
std::uint32_t sum_of(const Frame& frame, std::size_t begin, std::size_t end, std::uint32_t sum) {
  for (std::size_t i = begin; i + 1 < end; i += 2) sum += big_endian_16(frame, i);
  if ((end - begin) % 2 == 1) sum += static_cast<std::uint32_t>(frame[end - 1]) << 8;
  return sum;
}

std::uint16_t folded(std::uint32_t sum) {
  while (sum > 0xFFFF) sum = (sum & 0xFFFF) + (sum >> 16);
  return static_cast<std::uint16_t>(~sum);
}

std::string beside(const std::string& path) {
  return std::filesystem::path(path).replace_extension(".json").string();
}

void put_ipv4_header(Frame& frame, const Packet& packet) {
  frame.assign(20, 0);
  frame[0] = 0x45;
  put_big_endian(frame, 2, 20 + kUdpHeader + packet.payload.size());
  frame[6] = 0x40;  // in one piece
  frame[8] = kMostHops;
  frame[9] = kUdp;
  std::copy_n(packet.endpoint.address.begin() + 12, 4, frame.begin() + 12);
  std::fill_n(frame.begin() + 16, 4, 0xFF);
  put_big_endian(frame, 10, folded(sum_of(frame, 0, 20, 0)));
}

void put_ipv6_header(Frame& frame, const Packet& packet) {
  frame.assign(40, 0);
  frame[0] = 0x60;
  put_big_endian(frame, 4, kUdpHeader + packet.payload.size());
  frame[6] = kUdp;
  frame[7] = kMostHops;
  std::copy_n(packet.endpoint.address.begin(), 16, frame.begin() + 8);
  frame[24] = 0xFF;  // ff02::1, all nodes
  frame[25] = 0x02;
  frame[39] = 0x01;
}

void put_udp(Frame& frame, const Packet& packet) {
  const std::size_t header = frame.size();
  const std::size_t length = kUdpHeader + packet.payload.size();
  frame.resize(header + kUdpHeader);
  put_big_endian(frame, header, packet.endpoint.port);
  put_big_endian(frame, header + 2, packet.endpoint.port);
  put_big_endian(frame, header + 4, length);
  frame.insert(frame.end(), packet.payload.begin(), packet.payload.end());
  // The addresses are part of what is summed up.
  const std::size_t addresses = header == 20 ? 12 : 8;
  std::uint32_t sum = sum_of(frame, addresses, header, kUdp + static_cast<std::uint32_t>(length));
  sum = sum_of(frame, header, frame.size(), sum);
  const std::uint16_t checksum = folded(sum);
  put_big_endian(frame, header + 6, checksum == 0 ? 0xFFFF : checksum);  // 0 would be: none
}

/// The file's header: nanoseconds, version 2.4, raw IP.
constexpr std::array<std::uint32_t, 6> kFileHeader = {0xA1B23C4D, 0x00040002, 0, 0, kMaxFrame, 101};

}  // namespace

PcapWriter::PcapWriter(const std::string& path) : path_(path) {
  if (!path.ends_with(".pcap")) {
    throw Error("{}: expected a name that ends with .pcap for the packets", path);
  }
  if (std::filesystem::exists(beside(path))) {
    throw Error("{}: is there already, expected none beside {}; name another file", beside(path),
                path);
  }
  file_.reset(std::fopen(path.c_str(), "wbx"));
  if (!file_) {
    throw Error("{}: cannot be made for the packets ({}); name another file", path,
                std::strerror(errno));
  }
  write(kFileHeader.data(), sizeof kFileHeader);
}

PcapWriter::~PcapWriter() {
  if (has_packets_) return;
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
}

void PcapWriter::put_beside(const std::string& metadata) const {
  std::ofstream stream(beside(path_), std::ios::binary);
  stream << metadata;
  stream.close();
  if (!stream) throw Error("{}: cannot be written: the disk may be full", beside(path_));
}

void PcapWriter::add(const Packet& packet) {
  if (is_ipv4(packet.endpoint.address)) {
    put_ipv4_header(frame_, packet);
  } else {
    put_ipv6_header(frame_, packet);
  }
  put_udp(frame_, packet);
  has_packets_ = true;
  const auto bytes = static_cast<std::uint32_t>(frame_.size());
  const std::array<std::uint32_t, 4> header = {
      static_cast<std::uint32_t>(packet.capture_time_ns / 1'000'000'000),
      static_cast<std::uint32_t>(packet.capture_time_ns % 1'000'000'000), bytes, bytes};
  write(header.data(), sizeof header);
  write(frame_.data(), frame_.size());
}

void PcapWriter::write(const void* bytes, std::size_t count) {
  if (std::fwrite(bytes, 1, count, file_.get()) == count) return;
  throw Error("{}: cannot be written: the disk may be full", path_);
}

}  // namespace hqslam::live

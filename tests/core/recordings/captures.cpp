#include "captures.h"

namespace hqslam::test {
namespace {

void put_big(Payload& bytes, std::size_t at, std::int64_t value, std::size_t size) {
  for (std::size_t i = 0; i < size; ++i) {
    bytes[at + size - 1 - i] = static_cast<std::uint8_t>(value >> (8 * i));
  }
}

void put_bytes(Payload& packet, std::size_t at, const Payload& bytes) {
  std::ranges::copy(bytes, packet.begin() + at);
}

}  // namespace

std::vector<Payload> ethernet_frames(const Captured& captured, std::size_t fragment_bytes) {
  Payload datagram(8);
  put_big(datagram, 0, 443, 2);
  put_big(datagram, 2, captured.port, 2);
  put_big(datagram, 4, 8 + captured.payload.size(), 2);
  datagram.insert(datagram.end(), captured.payload.begin(), captured.payload.end());
  const std::size_t most = fragment_bytes == 0 ? datagram.size() : fragment_bytes;
  std::vector<Payload> frames;
  for (std::size_t at = 0; at < datagram.size(); at += most) {
    const std::size_t bytes = std::min(most, datagram.size() - at);
    Payload frame(14 + 20);
    put_big(frame, 12, 0x0800, 2);
    frame[14] = 0x45;
    put_big(frame, 16, 20 + bytes, 2);
    put_big(frame, 18, captured.time_ns / 1000 % 65536, 2);
    put_big(frame, 20, (at + bytes < datagram.size() ? 0x2000 : 0) | at / 8, 2);
    frame[23] = 17;
    put_bytes(frame, 26, {192, 168, 1, captured.sender});
    frame.insert(frame.end(), datagram.begin() + at, datagram.begin() + at + bytes);
    frames.push_back(std::move(frame));
  }
  return frames;
}

std::string pcap_bytes(const std::vector<Captured>& packets, std::size_t fragment_bytes) {
  std::string bytes;
  append(bytes, std::uint32_t{0xA1B2C3D4}, std::uint16_t{2}, std::uint16_t{4}, std::uint64_t{0},
         std::uint32_t{65535}, std::uint32_t{1});
  for (const Captured& captured : packets) {
    for (const Payload& frame : ethernet_frames(captured, fragment_bytes)) {
      const auto length = static_cast<std::uint32_t>(frame.size());
      append(bytes, static_cast<std::uint32_t>(captured.time_ns / 1'000'000'000),
             static_cast<std::uint32_t>(captured.time_ns % 1'000'000'000 / 1000), length, length,
             frame);
    }
  }
  return bytes;
}

std::string pcapng_interface(std::uint16_t link_type) {
  using Word = std::uint32_t;
  std::string bytes;
  append(bytes, Word{1}, Word{32}, Word{link_type}, Word{0}, std::uint16_t{9}, std::uint16_t{1},
         Word{9}, Word{0}, Word{32});  // if_tsresol 9: nanoseconds
  return bytes;
}

std::string pcapng_bytes(const std::vector<Captured>& packets) {
  using Word = std::uint32_t;
  std::string bytes;
  append(bytes, Word{0x0A0D0D0A}, Word{28}, Word{0x1A2B3C4D}, Word{1}, ~std::uint64_t{0}, Word{28});
  append(bytes, pcapng_interface(1));
  for (const Captured& captured : packets) {
    const Payload frame = ethernet_frames(captured).front();
    const auto length = static_cast<Word>(frame.size());
    const Word padded = (length + 3) / 4 * 4;
    append(bytes, Word{6}, 32 + padded, Word{0}, static_cast<Word>(captured.time_ns >> 32),
           static_cast<Word>(captured.time_ns), length, length, frame,
           std::string(padded - length, '\0'), 32 + padded);
  }
  return bytes;
}

Payload velodyne_packet(std::uint32_t time_us, const std::vector<int>& azimuths,
                        std::uint16_t distance, std::uint8_t intensity, std::uint8_t return_mode,
                        std::uint8_t product) {
  Payload packet(recordings::kVelodynePacketBytes);
  for (int i = 0; i < 12; ++i) {
    put(packet, 100 * i, std::uint16_t{0xEEFF});
    put(packet, 100 * i + 2, static_cast<std::uint16_t>(azimuths[i]));
    for (int c = 0; c < 32; ++c) set_measurement(packet, i, c, distance, intensity);
  }
  put(packet, 1200, time_us);
  packet[1204] = return_mode;
  packet[1205] = product;
  return packet;
}

void set_measurement(Payload& packet, int block, int channel, std::uint16_t distance,
                     std::uint8_t intensity) {
  const int at = 100 * block + 4 + 3 * channel;
  put(packet, at, distance);
  packet[at + 2] = intensity;
}

std::vector<Captured> velodyne_capture(const RoundRoom& room) {
  std::vector<Captured> result;
  const double degrees_per_us = 360.0 * room.rate_hz / 1e6;
  const double blind_deg = room.blind_to_deg - room.blind_from_deg;
  double time_us = 0.0;
  std::vector<int> azimuths;
  double first_us = 0.0;
  while (time_us < 1e6 * room.duration_s) {
    const double azimuth_deg = std::fmod(room.first_azimuth_deg + time_us * degrees_per_us, 360.0);
    if (azimuth_deg >= room.blind_from_deg && azimuth_deg < room.blind_to_deg) {
      time_us += blind_deg / degrees_per_us;
      continue;
    }
    if (azimuths.empty()) first_us = time_us;
    for (int i = 0; i < (room.dual ? 2 : 1); ++i) {
      azimuths.push_back(static_cast<int>(std::lround(100.0 * azimuth_deg)) % 36000);
    }
    time_us += room.firing_us;
    if (azimuths.size() < 12) continue;
    result.push_back({room.start_ns + std::llround(1e3 * first_us), 2368,
                      velodyne_packet(static_cast<std::uint32_t>(std::lround(first_us)), azimuths,
                                      2500, 10, room.dual ? 0x39 : 0x37, room.product)});
    azimuths.clear();
  }
  return result;
}

Payload hesai_packet_bytes(int lasers, std::uint32_t time_us, int azimuth, std::uint32_t number,
                           std::uint8_t return_mode, std::uint16_t distance) {
  const std::size_t block_bytes = 2 + 4 * lasers;
  const std::size_t tail = 12 + 8 * block_bytes;
  Payload packet(tail + 28);
  put_bytes(packet, 0, {0xEE, 0xFF, 6, 1, 0, 0, static_cast<std::uint8_t>(lasers), 8, 1, 4, 2, 1});
  const int step = return_mode >= 0x39 ? 2 : 1;
  for (int block = 0; block < 8; ++block) {
    put(packet, 12 + block * block_bytes,
        static_cast<std::uint16_t>((azimuth + 18 * (block / step)) % 36000));
    for (int i = 0; i < lasers; ++i) set_hesai_measurement(packet, lasers, block, i, distance);
  }
  packet[tail + 10] = return_mode;
  put(packet, tail + 11, std::uint16_t{599});
  put_bytes(packet, tail + 13,
            {120, 9, 13, 12, 26, static_cast<std::uint8_t>(40 + time_us / 1'000'000)});
  put(packet, tail + 19, time_us % 1'000'000);
  packet[tail + 23] = 0x42;
  put(packet, tail + 24, number);
  return packet;
}

void set_hesai_measurement(Payload& packet, int lasers, int block, int laser,
                           std::uint16_t distance, std::uint8_t reflectivity) {
  const int at = 12 + block * (2 + 4 * lasers) + 2 + 4 * laser;
  put(packet, at, distance);
  packet[at + 2] = reflectivity;
}

std::vector<Captured> hesai_capture(int lasers, double duration_s, std::uint8_t return_mode) {
  const int firings = return_mode >= 0x39 ? 4 : 8;
  std::vector<Captured> result;
  for (int i = 0; 50e-6 * firings * i < duration_s; ++i) {
    const int time_us = 50 * firings * i;
    result.push_back({1'600'000'000'000'000'000 + 1000LL * time_us, 2368,
                      hesai_packet_bytes(lasers, static_cast<std::uint32_t>(time_us),
                                         (30000 + 18 * firings * i) % 36000,
                                         static_cast<std::uint32_t>(i), return_mode)});
  }
  return result;
}

namespace {

void put_robosense_time(Payload& packet, bool helios, std::int64_t time_us) {
  if (helios) {
    put_big(packet, 20, 1'600'000'000 + time_us / 1'000'000, 6);
    put_big(packet, 26, time_us % 1'000'000, 4);
    return;
  }
  put_bytes(packet, 20, {20, 9, 13, 12, 26, static_cast<std::uint8_t>(40 + time_us / 1'000'000)});
  put_big(packet, 26, time_us / 1000 % 1000, 2);
  put_big(packet, 28, time_us % 1000, 2);
}

}  // namespace

Payload robosense_settings(const Robosense& sensor) {
  Payload packet(1248);
  put_bytes(packet, 0, {0xA5, 0xFF, 0x00, 0x5A, 0x11, 0x11, 0x55, 0x55});
  put_big(packet, 8, 599, 2);
  packet[300] = sensor.dual ? 0 : 4;
  for (int i = 0; i < 32; ++i) {
    const int at = 3 * i;
    if (!sensor.helios) {
      if (i < 16) put_big(packet, 1165 + at, 10'000 * (i < 8 ? 15 - 2 * i : 31 - 2 * i), 3);
      continue;
    }
    const int elevation = 1500 - i * 3200 / sensor.lasers;
    packet[468 + at] = static_cast<std::uint8_t>(i >= sensor.lasers ? 0xFF : elevation < 0);
    put_big(packet, 469 + at, std::abs(elevation), 2);
    put_big(packet, 565 + at, i % 2 == 1 ? 100 : 0, 2);
  }
  return packet;
}

void set_robosense_measurement(Payload& packet, int block, int channel, std::uint16_t distance,
                               std::uint8_t reflectivity) {
  const int at = 46 + 100 * block + 3 * channel;
  put_big(packet, at, distance, 2);
  packet[at + 2] = reflectivity;
}

std::vector<Captured> robosense_capture(const Robosense& sensor, double duration_s) {
  constexpr std::int64_t kBegin_ns = 1'600'000'000'000'000'000;
  std::vector<Captured> result = {{kBegin_ns, 7788, robosense_settings(sensor)}};
  const double firing_us = sensor.helios ? 55.56 : 55.5;
  const int firings = (sensor.lasers == 16 ? 24 : 12) / (sensor.dual ? 2 : 1);
  for (int i = 0; 1e-6 * firing_us * firings * i < duration_s; ++i) {
    const auto time_us = static_cast<std::int64_t>(firing_us * firings * i);
    Captured captured{kBegin_ns + 1000 * time_us, 6699, Payload(1248)};
    put_bytes(captured.payload, 0,
              sensor.helios ? Payload{0x55, 0xAA, 0x05, 0x5A}
                            : Payload{0x55, 0xAA, 0x05, 0x0A, 0x5A, 0xA5, 0x50, 0xA0});
    put_robosense_time(captured.payload, sensor.helios, time_us);
    for (int block = 0; block < 12; ++block) {
      const int firing = firings * i + block * firings / 12;
      const std::int64_t azimuth = 30000 + std::llround(0.36 * firing_us * firing);
      put_big(captured.payload, 42 + 100 * block, 0xFFEE, 2);
      put_big(captured.payload, 44 + 100 * block, azimuth % 36000, 2);
      for (int channel = 0; channel < 32; ++channel) {
        set_robosense_measurement(captured.payload, block, channel, sensor.distance);
      }
    }
    result.push_back(std::move(captured));
  }
  return result;
}

recordings::Packet as_packet(const Captured& captured) {
  recordings::Packet packet;
  packet.capture_time_ns = captured.time_ns;
  packet.endpoint.address = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 192, 168, 1, captured.sender};
  packet.endpoint.port = captured.port;
  packet.payload = captured.payload;
  return packet;
}

bool same_scans(const std::vector<RecordedScan>& a, const std::vector<RecordedScan>& b) {
  return std::ranges::equal(a, b, [](const RecordedScan& x, const RecordedScan& y) {
    return x.stamp_s == y.stamp_s && x.cloud.range_m == y.cloud.range_m;
  });
}

std::vector<RecordedScan> all_scans(ScanSource& source) {
  std::vector<RecordedScan> scans;
  while (auto scan = source.next()) scans.push_back(std::move(*scan));
  return scans;
}

}  // namespace hqslam::test

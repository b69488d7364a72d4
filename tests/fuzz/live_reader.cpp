
#include "captures.h"
#include "input_file.h"
#include "live_stream.h"

namespace hqslam::fuzz {
namespace {

using namespace hqslam::recordings;

constexpr int kLiveColumns = 16;
constexpr int kHosts = 4;
constexpr int kMostPackets = 1500;
constexpr std::int64_t kPacket_ns = 1'327'000;
/// A sensor that was heard within it keeps its address.
constexpr std::int64_t kSilence_ns = 1'000'000'000;

struct Step {
  explicit Step(Bytes bytes)
      : host(bytes[0] % kHosts),
        form(bytes[0] / kHosts % 8),
        packets(1 + bytes[1]),
        gap_ns(kGaps_ns[bytes[2] % kGaps_ns.size()]),
        clock_gap_ns(kGaps_ns[bytes[3] % kGaps_ns.size()]),
        turned(bytes[4]),
        damaged_at(std::size_t{bytes[5]} * 37),
        damage(bytes[6]) {}

  /// Also an hour, which is as long as a Velodyne's clock goes, and steps back.
  static constexpr std::array<std::int64_t, 8> kGaps_ns = {
      0,          100'000'000, 1'100'000'000,  10'000'000'000, 3'600'000'000'000,
      -2'000'000, -50'000'000, -1'100'000'000,
  };

  int host;
  /// 0 to 4: what another sensor would send, an empty packet or one of inertial data, a large one;
  /// else its own.
  int form;
  int packets;
  std::int64_t gap_ns;        ///< before the first of them
  std::int64_t clock_gap_ns;  ///< the same by the sender's clock
  int turned;                 ///< how far from packet to packet, in 16 hundredths of a degree
  std::size_t damaged_at;
  std::uint8_t damage;  ///< of one byte of each of them; 0: none
};

/// What a host has sent.
struct Host {
  std::int64_t clock_ns = 0;
  int azimuth = 0;
  std::uint32_t packets = 0;
};

/// By the number of the sensor: two Velodynes, then two Ousters.
constexpr int kSensors = 4;
constexpr std::array<OusterProfile, 2> kLiveProfiles = {OusterProfile::kLegacy,
                                                        OusterProfile::kRng19Dual};

/// Sixteen turns of each profile, again and again.
const test::Payload& ouster_packet(int profile, std::uint32_t number) {
  static const auto of_profile = [] {
    std::array<std::vector<test::Payload>, kLiveProfiles.size()> packets;
    for (std::size_t i = 0; i < kLiveProfiles.size(); ++i) {
      for (std::uint32_t turn = 0; turn < 16; ++turn) {
        for (auto& packet : test::ouster_turn(kLiveProfiles[i], turn, kOusterRows)) {
          packets[i].push_back(std::move(packet.payload));
        }
      }
    }
    return packets;
  }();
  return of_profile[profile][number % of_profile[profile].size()];
}

test::Payload payload(int sensor, const Step& step, const Host& host) {
  if (step.form == 3 && step.turned % 2 == 0) return {};
  if (step.form == 3) {
    test::Payload bytes = test::ouster_imu_packet(host.clock_ns);
    bytes[step.damaged_at % bytes.size()] ^= step.damage;
    return bytes;
  }
  if (step.form == 4) return test::Payload(4096, 0xEE);
  const int sent = step.form < 3 ? (sensor + 1 + step.form) % kSensors : sensor;
  test::Payload bytes;
  if (sent < 2) {
    static const std::array<test::Payload, 2> models = {
        test::velodyne_packet(0, std::vector<int>(12), 2500, 10, 0x37, 0x22),
        test::velodyne_packet(0, std::vector<int>(12), 2500, 10, 0x37, 0x21)};
    bytes = models[sent];
    for (int i = 0; i < 12; ++i) {
      const int azimuth = (host.azimuth + i * 16 * step.turned / 12) % 36000;
      test::put(bytes, 100 * static_cast<std::size_t>(i) + 2, static_cast<std::uint16_t>(azimuth));
    }
    test::put(bytes, 1200, static_cast<std::uint32_t>(host.clock_ns / 1000 % 3'600'000'000));
  } else {
    bytes = ouster_packet(sent - 2, host.packets);
  }
  if (!bytes.empty()) bytes[step.damaged_at % bytes.size()] ^= step.damage;
  return bytes;
}

live::LiveOptions options_for(int sensor) {
  if (sensor < 2) return {.sensor = sensor == 0 ? "vlp-16" : "hdl-32e"};
  const std::string text = test::ouster_metadata_text(kLiveProfiles[sensor - 2], kOusterRows);
  return {.sensor =
              as_file({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, ".json")};
}

void require(bool holds, const char* what) {
  if (!holds) throw std::logic_error(what);
}

/// What LiveSensor does with a packet, without a socket and threads.
class Listener {
 public:
  explicit Listener(int sensor) : stream_(options_for(sensor)), is_velodyne_(sensor < 2) {}

  /// is_usual: as the sensor that was named sends it.
  void add(const Packet& packet, bool is_usual) {
    if (!assembler_) {
      if (!stream_.recognize(packet)) return;
      assembler_ = stream_.assembler(is_velodyne_ ? kLiveColumns : 0);
    } else {
      const Endpoint before = stream_.sender();
      const bool is_sensors = stream_.is_sensors(packet);
      require(is_sensors == (stream_.sender() == packet.endpoint), "taken for another's");
      require(stream_.sender() == before || packet.capture_time_ns - last_usual_ns_ >= kSilence_ns,
              "another is the sensor while it sends");
      if (!is_sensors) return;
    }
    // The receiver's clock may be set back, and what is damaged may be understood or not.
    const std::int64_t now_ns = packet.capture_time_ns;
    last_usual_ns_ = is_usual ? now_ns : std::min(last_usual_ns_, now_ns);
    assembler_->add(packet);
    ++added_;
    take_scans();
    const PacketCounts& counts = assembler_->counts();
    const ImuCounts imu = assembler_->imu_counts();
    require(counts.used + counts.late + counts.foreign + imu.used + imu.left_out == added_,
            "packets are not counted once");
    require(counts.lost >= 0 && assembler_->lost_scans() >= 0, "less than nothing is lost");
  }

  void finish() {
    stream_.complaint();
    if (!assembler_) return;
    assembler_->finish();
    take_scans();
  }

 private:
  void take_scans() {
    while (true) {
      try {
        const auto scan = assembler_->next();
        if (!scan) return;
        require(std::isfinite(scan->stamp_s), "a scan has no time");
        for (const ImuSample& sample : scan->imu) {
          require(std::isfinite(sample.stamp_s), "an inertial sample has no time");
        }
      } catch (const ScanError&) {
        continue;  // left out
      }
    }
  }

  live::LiveStream stream_;
  bool is_velodyne_;
  std::unique_ptr<ScanAssembler> assembler_;
  std::int64_t added_ = 0;
  std::int64_t last_usual_ns_ = 0;
};

}  // namespace

void live_packets(Bytes input) {
  if (input.empty()) return;
  const int sensor = input[0] % kSensors;
  Listener listener(sensor);
  std::array<Host, kHosts> hosts;
  Packet packet;
  packet.capture_time_ns = 1'600'000'000'000'000'000;
  int sent = 0;
  for (std::size_t at = 1; at + kLiveStepBytes <= input.size(); at += kLiveStepBytes) {
    const Step step(input.subspan(at, kLiveStepBytes));
    Host& host = hosts[step.host];
    packet.endpoint.address[15] = static_cast<std::uint8_t>(1 + step.host);
    packet.capture_time_ns += step.gap_ns;
    host.clock_ns = std::max<std::int64_t>(0, host.clock_ns + step.clock_gap_ns);
    for (int i = 0; i < step.packets && sent < kMostPackets; ++i, ++sent) {
      const test::Payload bytes = payload(sensor, step, host);
      packet.payload = bytes;
      listener.add(packet, step.form > 4 && step.damage == 0);
      packet.capture_time_ns += kPacket_ns;
      host.clock_ns += kPacket_ns;
      host.azimuth = (host.azimuth + 16 * step.turned) % 36000;
      ++host.packets;
    }
  }
  listener.finish();
}

}  // namespace hqslam::fuzz

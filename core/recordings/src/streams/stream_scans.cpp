#include "streams/stream_scans.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "bags/message_packets.h"
#include "hqslam/core/angles.h"
#include "hqslam/core/error.h"
#include "packets/ouster_decoder.h"

namespace hqslam::recordings {

StreamScans::StreamScans(StreamReader reader, RecordingInfo info)
    : reader_(std::move(reader)), info_(std::move(info)) {
  info_.kind = reader_.file().kind();
  info_.stream = reader_.stream().name;
  info_.has_stamps = true;
  const ImuStream& imu = reader_.imu();
  if (imu.stream) info_.imu_stream = reader_.file().streams()[*imu.stream].name;
  if (!imu.note.empty()) info_.warnings.push_back(fmt::format("{}: {}", reader_.path(), imu.note));
  reader_.give_imu_to([this](const Message& message) { add_imu(message); });
}

void StreamScans::add_imu(const Message& message) {
  try {
    imu_.add(imu_sample(message, reader_.imu().R_sensor_imu));
  } catch (const Error&) {
    imu_.add_damaged();
  }
}

/// A scan without inertial samples of its own takes those up to its end.
void StreamScans::take_imu(RecordedScan& scan) {
  if (scan.imu.empty()) {
    scan.imu = imu_.take(scan.stamp_s + 0.5 * info_.sensor.scan_period_s, 0.0);
  }
  if (scan.imu.empty()) return;
  if (imu_samples_ == 0) first_imu_s_ = scan.imu.front().stamp_s;
  last_imu_s_ = scan.imu.back().stamp_s;
  imu_samples_ += std::ssize(scan.imu);
}

std::optional<RecordedScan> StreamScans::next() {
  if (ended_) return std::nullopt;
  begun_ = true;
  try {
    std::optional<RecordedScan> scan = read();
    if (!scan) {
      end();
      return std::nullopt;
    }
    const double first_s = info_.scans == 0 ? scan->stamp_s : info_.first_stamp_s;
    info_.first_stamp_s = std::min(first_s, scan->stamp_s);
    last_stamp_s_ = std::max(info_.scans == 0 ? scan->stamp_s : last_stamp_s_, scan->stamp_s);
    ++info_.scans;
    take_imu(*scan);
    return scan;
  } catch (const ScanError&) {
    ++info_.scans;
    throw;
  }
}

void StreamScans::end() {
  ended_ = true;
  complete(info_);
  info_.imu = imu_counts();
  if (imu_samples_ > 1 && last_imu_s_ > first_imu_s_) {
    info_.imu_rate_hz = static_cast<double>(imu_samples_ - 1) / (last_imu_s_ - first_imu_s_);
  }
  if (info_.imu.left_out > 0) {
    info_.warnings.push_back(
        fmt::format("{}: {} inertial samples were left out: damaged, not in order or of another "
                    "time than the scans",
                    reader_.path(), info_.imu.left_out));
  }
  info_.duration_s = last_stamp_s_ - info_.first_stamp_s + info_.sensor.scan_period_s;
  if (const std::string text = reader_.file().complaint(); !text.empty()) {
    info_.warnings.push_back(fmt::format("{}: {}", reader_.path(), text));
  }
  if (const std::string text = reader_.passed_over(); !text.empty()) info_.warnings.push_back(text);
  if (info_.scans == 0) {
    throw Error(
        "{}: expected at least one turn of the sensor, found less than that in {} packets; record "
        "longer",
        reader_.path(), reader_.stream().messages);
  }
  if (const std::string text = reader_.file().missing(); !text.empty()) {
    throw Error("{}: {}", reader_.path(), text);
  }
}

void StreamScans::use_columns(int columns) {
  if (columns == info_.sensor.columns) return;
  if (begun_) {
    throw Error(
        "{}: scans were read with {} columns already, expected {} to be asked for before; open it "
        "again",
        reader_.path(), info_.sensor.columns, columns);
  }
  info_.sensor.columns = columns;
  validate(info_.sensor);
  sensor_changed();
}

RecordingInfo StreamScans::info() const {
  RecordingInfo info = info_;
  info.streams = reader_.file().streams();
  std::ranges::sort(info.streams, [](const Stream& a, const Stream& b) {
    return std::tie(a.endpoint, a.name) < std::tie(b.endpoint, b.name);
  });
  return info;
}

namespace {

class PacketScans : public StreamScans {
 public:
  PacketScans(StreamReader reader, RecordingInfo info, MakeAssembler make)
      : StreamScans(std::move(reader), std::move(info)),
        packets_(reader_.stream(), [this] { return reader_.next(); }),
        make_(std::move(make)) {
    info_.has_point_times = true;
    sensor_changed();
  }

 private:
  std::optional<RecordedScan> read() override {
    while (true) {
      std::optional<RecordedScan> scan = assembler_->next();
      if (scan || finished_) return scan;
      if (const auto packet = packets_.next()) {
        assembler_->add(*packet);
      } else {
        assembler_->finish();
        finished_ = true;
      }
    }
  }

  void sensor_changed() override { assembler_ = make_(info_.sensor); }

  void add_imu(const Message& message) override {
    const Stream& stream = reader_.file().streams()[message.stream];
    if (!carries_packets(stream.type)) return StreamScans::add_imu(message);
    const auto packet = first_packet_of(stream, message);
    if (packet && packet->payload.size() == kOusterImuBytes) assembler_->add(*packet);
  }

  ImuCounts imu_counts() const override {
    ImuCounts counts = StreamScans::imu_counts();
    counts.used += assembler_->imu_counts().used;
    counts.left_out += assembler_->imu_counts().left_out;
    return counts;
  }

  void complete(RecordingInfo& info) override {
    info.packets = assembler_->counts();
    info.lost_scans = assembler_->lost_scans();
    info.partial_scans = assembler_->partial_scans();
    std::string text = packets_.complaint();
    const auto add = [&](std::int64_t count, const char* what) {
      if (count > 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, what);
    };
    const std::int64_t lost = info.packets.lost;
    add(lost, lost == 1 ? "packet was lost" : "packets were lost");
    add(info.lost_scans, info.lost_scans == 1 ? "whole turn was lost" : "whole turns were lost");
    add(info.packets.late, "came late or twice and were left out");
    if (!text.empty()) info.warnings.push_back(fmt::format("{}: {}", reader_.path(), text));
  }

  MessagePackets packets_;
  MakeAssembler make_;
  std::unique_ptr<ScanAssembler> assembler_;
  bool finished_ = false;
};

}  // namespace

void set_columns(SensorModel& sensor, int wanted, bool is_preset) {
  constexpr double kPresetPeriod_s = 0.1;
  if (wanted > 0) {
    sensor.columns = wanted;
  } else if (is_preset) {
    const double columns = sensor.columns * sensor.scan_period_s / kPresetPeriod_s;
    sensor.columns = std::clamp(static_cast<int>(std::lround(columns / 100.0)) * 100, 100, 10000);
  }
}

void warn_of_other_beams(const SensorModel& named, const SensorModel& expected,
                         const std::string& path, std::vector<std::string>& warnings) {
  constexpr double kFarthest_deg = 1.5;
  double off_deg = 0.0;
  for (int row = 0; row < std::min(named.rows(), expected.rows()); ++row) {
    const double off_rad = named.beam_elevation_rad[row] - expected.beam_elevation_rad[row];
    off_deg = std::max(off_deg, degrees(std::abs(off_rad)));
  }
  if (off_deg <= kFarthest_deg) return;
  warnings.push_back(fmt::format(
      "{}: the packets are read with the beams of the named sensor '{}', up to {:.1f} degrees "
      "beside {}'s",
      path, named.name, off_deg, expected.name));
}

std::unique_ptr<StreamScans> packet_scans(StreamReader reader, RecordingInfo info,
                                          MakeAssembler make) {
  return std::make_unique<PacketScans>(std::move(reader), std::move(info), std::move(make));
}

}  // namespace hqslam::recordings

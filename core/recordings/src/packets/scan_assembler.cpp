#include "hqslam/recordings/scan_assembler.h"

#include <fmt/format.h>

#include <utility>

#include "hqslam/core/error.h"
#include "imu_queue.h"
#include "packets/ouster_decoder.h"
#include "packets/velodyne_decoder.h"

namespace hqslam::recordings {

namespace {

class OusterAssembler : public ScanAssembler {
 public:
  OusterAssembler(const OusterMetadata& metadata, std::string name, const OusterOptions& options)
      : metadata_(metadata),
        decoder_(metadata, options),
        geometry_(metadata, options),
        name_(std::move(name)) {}

  const SensorModel& sensor() const override { return metadata_.sensor; }
  void add(const Packet& packet) override {
    if (packet.payload.size() != kOusterImuBytes) return decoder_.add(packet, frames_);
    imu_.add(ouster_imu_sample(packet.payload, metadata_));
  }
  void finish() override { decoder_.finish(frames_); }
  const PacketCounts& counts() const override { return decoder_.counts(); }
  ImuCounts imu_counts() const override { return imu_.counts(); }
  std::int64_t lost_scans() const override { return decoder_.lost_scans(); }
  std::int64_t partial_scans() const override { return decoder_.partial_scans(); }

  std::optional<RecordedScan> next() override {
    if (frames_.empty()) return std::nullopt;
    OusterFrame frame = std::move(frames_.front());
    frames_.erase(frames_.begin());
    RecordedScan result;
    result.name = fmt::format("{}[{}]", name_, taken_++);
    std::optional<OusterScan> scan = geometry_.scan(frame);
    if (!scan) {
      throw ScanError(
          "{}: expected columns of one turn, found times of more than a second or none; the "
          "packets are damaged",
          result.name);
    }
    result.stamp_s = scan->stamp_s;
    result.imu = imu_.take(scan->sensor_stamp_s + 0.5 * metadata_.sensor.scan_period_s,
                           scan->stamp_s - scan->sensor_stamp_s);
    result.cloud = std::move(scan->cloud);
    for (const float range_m : result.cloud.range_m) result.counts.kept += range_m > 0.0F ? 1 : 0;
    std::int64_t returns = 0;
    for (std::size_t i = 0; i < frame.range_mm.size(); ++i) {
      const bool second = !frame.second_range_mm.empty() && frame.second_range_mm[i] > 0;
      returns += frame.range_mm[i] > 0 || second ? 1 : 0;
    }
    result.counts.out_of_range = returns - result.counts.kept;
    return result;
  }

 private:
  OusterMetadata metadata_;
  OusterDecoder decoder_;
  OusterGeometry geometry_;
  std::string name_;
  std::vector<OusterFrame> frames_;
  std::int64_t taken_ = 0;
  ImuQueue imu_;
};

}  // namespace

std::unique_ptr<ScanAssembler> velodyne_assembler(const VelodyneStream& stream,
                                                  const SensorModel& sensor, std::string name,
                                                  const TurnDecoderOptions& options) {
  return std::make_unique<VelodyneDecoder>(stream, sensor, options, std::move(name));
}

std::unique_ptr<ScanAssembler> ouster_assembler(const OusterMetadata& metadata, std::string name,
                                                const OusterOptions& options) {
  return std::make_unique<OusterAssembler>(metadata, std::move(name), options);
}

}  // namespace hqslam::recordings

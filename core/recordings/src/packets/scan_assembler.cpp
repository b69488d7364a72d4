#include "hqslam/recordings/scan_assembler.h"

#include <utility>

#include "hqslam/core/error.h"
#include "imu_queue.h"
#include "packets/ouster_decoder.h"
#include "packets/point_assembler.h"
#include "packets/velodyne_decoder.h"

namespace hqslam::recordings {

namespace {

class OusterAssembler : public AssemblerOf<OusterDecoder, OusterFrame> {
 public:
  OusterAssembler(const OusterMetadata& metadata, std::string name, const OusterOptions& options)
      : AssemblerOf(metadata.sensor, std::move(name), {metadata, options}),
        metadata_(metadata),
        geometry_(metadata, options) {}

  void add(const Packet& packet) override {
    if (packet.payload.size() != kOusterImuBytes) return AssemblerOf::add(packet);
    imu_.add(ouster_imu_sample(packet.payload, metadata_));
  }
  ImuCounts imu_counts() const override { return imu_.counts(); }

 private:
  void put(OusterFrame& frame, RecordedScan& result) override {
    std::optional<OusterScan> scan = geometry_.scan(frame);
    if (!scan) {
      throw ScanError(
          "{}: expected columns of one turn, found times of more than a second or none; the "
          "packets are damaged",
          result.name);
    }
    result.stamp_s = scan->stamp_s;
    result.imu = imu_.take(scan->sensor_stamp_s + 0.5 * sensor_.scan_period_s,
                           scan->stamp_s - scan->sensor_stamp_s);
    result.cloud = std::move(scan->cloud);
    for (const float range_m : result.cloud.range_m) result.counts.kept += range_m > 0.0F ? 1 : 0;
    std::int64_t returns = 0;
    for (std::size_t i = 0; i < frame.range_mm.size(); ++i) {
      const bool second = !frame.second_range_mm.empty() && frame.second_range_mm[i] > 0;
      returns += frame.range_mm[i] > 0 || second ? 1 : 0;
    }
    result.counts.out_of_range = returns - result.counts.kept;
  }

  OusterMetadata metadata_;
  OusterGeometry geometry_;
  ImuQueue imu_;
};

}  // namespace

std::unique_ptr<ScanAssembler> velodyne_assembler(const VelodyneStream& stream,
                                                  const SensorModel& sensor, std::string name,
                                                  const TurnDecoderOptions& options) {
  return point_assembler(sensor, std::move(name), VelodyneDecoder(stream, sensor, options));
}

std::unique_ptr<ScanAssembler> ouster_assembler(const OusterMetadata& metadata, std::string name,
                                                const OusterOptions& options) {
  return std::make_unique<OusterAssembler>(metadata, std::move(name), options);
}

}  // namespace hqslam::recordings

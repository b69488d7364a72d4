#include "hqslam/recordings/scan_assembler.h"

#include <fmt/format.h>

#include <utility>
#include <vector>

#include "hesai_decoder.h"
#include "hqslam/core/error.h"
#include "hqslam/core/projection.h"
#include "imu_queue.h"
#include "lslidar_decoder.h"
#include "ouster_decoder.h"
#include "ouster_imu.h"
#include "robosense_decoder.h"
#include "velodyne_decoder.h"

namespace hqslam::recordings {

namespace {

/// What is the same for every sensor: a decoder, and the turns that it has completed.
template <typename Decoder, typename Turn>
class AssemblerOf : public ScanAssembler {
 public:
  AssemblerOf(const SensorModel& sensor, std::string name, Decoder decoder)
      : sensor_(sensor), decoder_(std::move(decoder)), name_(std::move(name)) {}

  const SensorModel& sensor() const override { return sensor_; }
  void add(const Packet& packet) override { decoder_.add(packet, turns_); }
  void finish() override { decoder_.finish(turns_); }
  const PacketCounts& counts() const override { return decoder_.counts(); }
  std::int64_t lost_scans() const override { return decoder_.lost_scans(); }
  std::int64_t partial_scans() const override { return decoder_.partial_scans(); }

  std::optional<RecordedScan> next() override {
    if (turns_.empty()) return std::nullopt;
    Turn turn = std::move(turns_.front());
    turns_.erase(turns_.begin());
    RecordedScan result;
    result.name = fmt::format("{}[{}]", name_, taken_++);
    put(turn, result);
    return result;
  }

 protected:
  virtual void put(Turn& turn, RecordedScan& result) = 0;

  SensorModel sensor_;
  Decoder decoder_;

 private:
  std::string name_;
  std::vector<Turn> turns_;
  std::int64_t taken_ = 0;
};

/// Of a decoder whose turns are scans.
template <typename Decoder>
class PointAssembler : public AssemblerOf<Decoder, Scan> {
  using AssemblerOf<Decoder, Scan>::AssemblerOf;

  void put(Scan& scan, RecordedScan& result) override {
    ProjectedScan projected = project(scan, this->sensor_);
    result.stamp_s = scan.stamp_s;
    result.cloud = std::move(projected.cloud);
    result.counts = projected.counts;
    this->decoder_.reuse(std::move(scan));
  }
};

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
                                                  const VelodyneOptions& options) {
  return std::make_unique<PointAssembler<VelodyneDecoder>>(
      sensor, std::move(name), VelodyneDecoder(stream, sensor, options));
}

std::unique_ptr<ScanAssembler> hesai_assembler(const SensorModel& sensor, std::string name,
                                               const VelodyneOptions& options) {
  return std::make_unique<PointAssembler<HesaiDecoder>>(sensor, std::move(name),
                                                        HesaiDecoder(sensor, options));
}

std::unique_ptr<ScanAssembler> robosense_assembler(const RobosenseUnit& unit,
                                                   const SensorModel& sensor, std::string name,
                                                   const VelodyneOptions& options) {
  return std::make_unique<PointAssembler<RobosenseDecoder>>(
      sensor, std::move(name), RobosenseDecoder(unit, sensor, options));
}

std::unique_ptr<ScanAssembler> lslidar_assembler(const LslidarUnit& unit, const SensorModel& sensor,
                                                 std::string name, const VelodyneOptions& options) {
  return std::make_unique<PointAssembler<LslidarDecoder>>(sensor, std::move(name),
                                                          LslidarDecoder(unit, sensor, options));
}

std::unique_ptr<ScanAssembler> ouster_assembler(const OusterMetadata& metadata, std::string name,
                                                const OusterOptions& options) {
  return std::make_unique<OusterAssembler>(metadata, std::move(name), options);
}

}  // namespace hqslam::recordings

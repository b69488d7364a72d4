#pragma once

#include <fmt/format.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hqslam/core/projection.h"
#include "hqslam/recordings/scan_assembler.h"

namespace hqslam::recordings {

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

/// The scans of a decoder of the sensor's packets; as velodyne_assembler.
template <typename Decoder>
std::unique_ptr<ScanAssembler> point_assembler(const SensorModel& sensor, std::string name,
                                               Decoder decoder) {
  return std::make_unique<PointAssembler<Decoder>>(sensor, std::move(name), std::move(decoder));
}

}  // namespace hqslam::recordings

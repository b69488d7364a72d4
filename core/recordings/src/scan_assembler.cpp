#include "hqslam/recordings/scan_assembler.h"

#include <fmt/format.h>

#include <deque>
#include <utility>
#include <vector>

#include "hqslam/core/error.h"
#include "hqslam/core/projection.h"

namespace hqslam::recordings {

namespace {

/// What a decoder has completed, and how many were taken.
template <typename Complete>
class Ready {
 public:
  std::vector<Complete>& new_ones() { return new_; }
  std::optional<Complete> take() {
    for (Complete& complete : new_) waiting_.push_back(std::move(complete));
    new_.clear();
    if (waiting_.empty()) return std::nullopt;
    Complete first = std::move(waiting_.front());
    waiting_.pop_front();
    ++taken_;
    return first;
  }
  /// The name of the one that was taken last.
  std::string name(const std::string& recording) const {
    return fmt::format("{}[{}]", recording, taken_ - 1);
  }

 private:
  std::vector<Complete> new_;
  std::deque<Complete> waiting_;
  std::int64_t taken_ = 0;
};

class VelodyneAssembler : public ScanAssembler {
 public:
  VelodyneAssembler(const VelodyneStream& stream, const SensorModel& sensor, std::string name,
                    const VelodyneOptions& options)
      : sensor_(sensor), name_(std::move(name)), decoder_(stream, sensor, options) {}

  const SensorModel& sensor() const override { return sensor_; }
  void add(const Packet& packet) override { decoder_.add(packet, ready_.new_ones()); }
  void finish() override { decoder_.finish(ready_.new_ones()); }
  const PacketCounts& counts() const override { return decoder_.counts(); }
  std::int64_t lost_scans() const override { return decoder_.lost_scans(); }
  std::int64_t partial_scans() const override { return decoder_.partial_scans(); }

  std::optional<RecordedScan> next() override {
    std::optional<Scan> scan = ready_.take();
    if (!scan) return std::nullopt;
    ProjectedScan projected = project(*scan, sensor_);
    RecordedScan result;
    result.name = ready_.name(name_);
    result.stamp_s = scan->stamp_s;
    result.cloud = std::move(projected.cloud);
    result.counts = projected.counts;
    decoder_.reuse(std::move(*scan));
    return result;
  }

 private:
  SensorModel sensor_;
  std::string name_;
  VelodyneDecoder decoder_;
  Ready<Scan> ready_;
};

class OusterAssembler : public ScanAssembler {
 public:
  OusterAssembler(const OusterMetadata& metadata, std::string name, const OusterOptions& options)
      : sensor_(metadata.sensor),
        name_(std::move(name)),
        decoder_(metadata, options),
        geometry_(metadata, options) {}

  const SensorModel& sensor() const override { return sensor_; }
  void add(const Packet& packet) override { decoder_.add(packet, ready_.new_ones()); }
  void finish() override { decoder_.finish(ready_.new_ones()); }
  const PacketCounts& counts() const override { return decoder_.counts(); }
  std::int64_t lost_scans() const override { return decoder_.lost_frames(); }
  std::int64_t partial_scans() const override { return decoder_.partial_frames(); }

  std::optional<RecordedScan> next() override {
    const std::optional<OusterFrame> frame = ready_.take();
    if (!frame) return std::nullopt;
    RecordedScan result;
    result.name = ready_.name(name_);
    std::optional<OusterScan> scan = geometry_.scan(*frame);
    if (!scan) {
      throw ScanError(
          fmt::format("{}: expected columns of one turn, found times of more than a "
                      "second or none; the packets are damaged",
                      result.name));
    }
    result.stamp_s = scan->stamp_s;
    result.cloud = std::move(scan->cloud);
    count(*frame, result);
    return result;
  }

 private:
  static void count(const OusterFrame& frame, RecordedScan& result) {
    for (const float range_m : result.cloud.range_m) result.counts.kept += range_m > 0.0F ? 1 : 0;
    std::int64_t returns = 0;
    for (std::size_t i = 0; i < frame.range_mm.size(); ++i) {
      const bool second = !frame.second_range_mm.empty() && frame.second_range_mm[i] > 0;
      returns += frame.range_mm[i] > 0 || second ? 1 : 0;
    }
    result.counts.out_of_range = returns - result.counts.kept;
  }

  SensorModel sensor_;
  std::string name_;
  OusterDecoder decoder_;
  OusterGeometry geometry_;
  Ready<OusterFrame> ready_;
};

}  // namespace

std::unique_ptr<ScanAssembler> velodyne_assembler(const VelodyneStream& stream,
                                                  const SensorModel& sensor, std::string name,
                                                  const VelodyneOptions& options) {
  return std::make_unique<VelodyneAssembler>(stream, sensor, std::move(name), options);
}

std::unique_ptr<ScanAssembler> ouster_assembler(const OusterMetadata& metadata, std::string name,
                                                const OusterOptions& options) {
  return std::make_unique<OusterAssembler>(metadata, std::move(name), options);
}

}  // namespace hqslam::recordings

#include "packet_scans.h"

#include <fmt/format.h>

#include <utility>

#include "hqslam/core/error.h"

namespace hqslam::recordings {

namespace {

/// The packets of a file, as its scans.
class PacketScanSource : public ScanSource {
 public:
  PacketScanSource(std::shared_ptr<const RecordingFile> file, const Stream& stream,
                   const RecordingInfo& info, std::unique_ptr<ScanAssembler> assembler)
      : file_(std::move(file)),
        packets_(file_->packets(stream)),
        assembler_(std::move(assembler)),
        size_(info.scans),
        warnings_(info.warnings) {}

  const SensorModel& sensor() const override { return assembler_->sensor(); }
  std::int64_t size() const override { return size_; }
  std::vector<std::string> warnings() const override { return warnings_; }

  std::optional<RecordedScan> next() override {
    while (true) {
      std::optional<RecordedScan> scan = assembler_->next();
      if (scan || ended_) return scan;
      if (const auto packet = packets_->next()) {
        assembler_->add(*packet);
      } else {
        assembler_->finish();
        ended_ = true;
      }
    }
  }

 private:
  std::shared_ptr<const RecordingFile> file_;
  std::unique_ptr<PacketSource> packets_;
  std::unique_ptr<ScanAssembler> assembler_;
  std::int64_t size_;
  std::vector<std::string> warnings_;
  bool ended_ = false;
};

}  // namespace

std::unique_ptr<ScanSource> packet_scan_source(std::shared_ptr<const RecordingFile> file,
                                               const Stream& stream, const RecordingInfo& info,
                                               std::unique_ptr<ScanAssembler> assembler) {
  return std::make_unique<PacketScanSource>(std::move(file), stream, info, std::move(assembler));
}

void judge_counts(const Stream& stream, const std::string& path, RecordingInfo& info) {
  if (info.scans == 0) {
    throw Error(
        fmt::format("{}: expected at least one turn of the sensor, found less than that in "
                    "{} packets; record longer",
                    path, stream.messages));
  }
  std::string text;
  const auto say = [&](std::int64_t count, const char* what) {
    if (count > 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, what);
  };
  const std::int64_t lost = info.packets.lost;
  say(lost, lost == 1 ? "packet was lost" : "packets were lost");
  say(info.lost_scans, info.lost_scans == 1 ? "whole turn was lost" : "whole turns were lost");
  say(info.packets.late, "came late or twice and were left out");
  if (!text.empty()) info.warnings.push_back(fmt::format("{}: {}", path, text));
}

}  // namespace hqslam::recordings

#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "hqslam/core/scan_source.h"

namespace hqslam::recordings {

/// A source that changes the scans of another one; all else is the other one's.
class WrappedSource : public ScanSource {
 public:
  explicit WrappedSource(std::unique_ptr<ScanSource> source) : source_(std::move(source)) {}

  const SensorModel& sensor() const override { return source_->sensor(); }
  std::optional<std::int64_t> size() const override { return source_->size(); }
  double read_share() const override { return source_->read_share(); }
  bool has_stamps() const override { return source_->has_stamps(); }
  std::vector<std::string> warnings() const override { return source_->warnings(); }

 protected:
  std::unique_ptr<ScanSource> source_;
};

}  // namespace hqslam::recordings

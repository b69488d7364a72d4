#include "hqslam/nn/training/training_scans.h"

#include <fmt/format.h>

#include "hqslam/core/error.h"

namespace hqslam::nn {

ScansInMemory::ScansInMemory(std::vector<RangeImage> scans) : scans_(std::move(scans)) {
  for (const RangeImage& scan : scans_) {
    if (scan.rows != rows() || scan.columns != columns()) {
      throw Error(fmt::format("training: a scan of {} x {}, expected {} x {} as the first one has",
                              scan.rows, scan.columns, rows(), columns()));
    }
  }
}

RangeImage ScansInMemory::read(std::int64_t i) const {
  if (i < 0 || i >= size()) {
    throw Error(fmt::format("training: scan {}, expected 0 to {}", i, size() - 1));
  }
  return scans_[static_cast<std::size_t>(i)];
}

}  // namespace hqslam::nn

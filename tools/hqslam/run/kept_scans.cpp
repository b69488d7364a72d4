#include "run/kept_scans.h"

#include <cmath>
#include <limits>

#include "pages/drive_scans.h"

namespace hqslam::tools {
namespace {

/// Every second element, the first included: of whole rows those of every second column.
template <typename Value>
void halve(std::vector<Value>& values, std::size_t columns) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i % columns % 2 == 0) values[kept++] = values[i];
  }
  values.resize(kept);
  values.shrink_to_fit();
}

}  // namespace

KeptScan KeptScans::thinned(std::size_t pose, const OrganizedCloud& cloud) const {
  KeptScan scan{.pose = pose, .range = {}, .time_offset_s = {}};
  for (int column = 0; column < cloud.columns; column += column_step_) {
    scan.time_offset_s.push_back(std::numeric_limits<float>::quiet_NaN());
  }
  for (int row = 0; row < cloud.rows; ++row) {
    for (int column = 0; column < cloud.columns; column += column_step_) {
      const std::size_t pixel = cloud.index(row, column);
      const float steps = std::round(cloud.range_m[pixel] / kRangeStep_m);
      const bool is_return = steps > 0.0F && steps <= 65535.0F;
      scan.range.push_back(is_return ? static_cast<std::uint16_t>(steps) : 0);
      float& offset_s = scan.time_offset_s[static_cast<std::size_t>(column / column_step_)];
      if (is_return && !cloud.time_offset_s.empty() && std::isnan(offset_s)) {
        offset_s = cloud.time_offset_s[pixel];
      }
    }
  }
  return scan;
}

void KeptScans::thin() {
  if (scans_.back().time_offset_s.size() < kFewColumns) {
    every_ *= 2;
    std::erase_if(scans_, [&](const KeptScan& scan) { return scan.pose % every_ != 0; });
    return;
  }
  column_step_ *= 2;
  for (KeptScan& scan : scans_) {
    halve(scan.range, scan.time_offset_s.size());
    halve(scan.time_offset_s, scan.time_offset_s.size());
  }
}

}  // namespace hqslam::tools

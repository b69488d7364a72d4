#include "run/covariances_csv.h"

#include <fmt/format.h>

#include <iterator>

namespace hqslam::tools {

std::string covariances_csv(const SlamRun& run) {
  constexpr const char* kAxes[] = {"x", "y", "z", "rx", "ry", "rz"};
  std::string text =
      "# covariance of e = (x y z rx ry rz) in T_true = T_map_sensor exp(e), in the sensor's "
      "frame, "
      "the first scan's pose being exact; m^2, m rad, rad^2; mapping: whether it was "
      "located; part: of the map, between which nothing is known\nstamp_s,mapping,part";
  for (const char* row : kAxes) {
    for (const char* column : kAxes) text += fmt::format(",{}_{}", row, column);
  }
  text += '\n';
  for (std::size_t i = 0; i < run.scans.size(); ++i) {
    const ScanRecord& scan = run.scans[i];
    text += fmt::format("{:.9f},{},{}", scan.report.stamp_s, slam::name(scan.report.mapping_status),
                        run.part_of_scan[i]);
    for (int row = 0; row < 6; ++row) {
      for (int column = 0; column < 6; ++column) {
        fmt::format_to(std::back_inserter(text), ",{:.6g}", scan.report.covariance(row, column));
      }
    }
    text += '\n';
  }
  return text;
}

}  // namespace hqslam::tools

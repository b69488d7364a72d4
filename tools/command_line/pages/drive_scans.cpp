#include "pages/drive_scans.h"

#include <cmath>
#include <utility>

#include "pages/page.h"

namespace hqslam::tools {
namespace {

constexpr float kTimeStep_s = 1e-4F;

/// Whole numbers as base64 of units of 4 bits, of a byte the low ones first. A number is 1 + n,
/// where n = 0, 1, 2, 3, ... stands for a step of 0, -1, 1, -2, ... from the number before it; no
/// number is 0. Of the value 3 bits are in a unit, the lowest first; bit 3: another unit follows.
class StepCode {
 public:
  void add(int number) {
    const int step = number - std::exchange(last_, number);
    add_units(static_cast<unsigned>(step < 0 ? -2 * step : 2 * step + 1));
  }
  void add_none() { add_units(0); }
  std::string base64() const { return tools::base64(bytes_); }

 private:
  void add_units(unsigned value) {
    for (; value > 7; value >>= 3U) add_unit(8U | (value & 7U));
    add_unit(value);
  }
  void add_unit(unsigned unit) {
    if (is_half_) bytes_.back() |= static_cast<std::uint8_t>(unit << 4U);
    if (!is_half_) bytes_.push_back(static_cast<std::uint8_t>(unit));
    is_half_ = !is_half_;
  }

  std::vector<std::uint8_t> bytes_;
  bool is_half_ = false;  ///< of the last byte only the low bits are taken
  int last_ = 0;
};

/// First the time of each column, then row after row the ranges.
std::string code_of(const ViewRangeImage& scan) {
  StepCode code;
  for (const float offset_s : scan.time_offset_s) {
    std::isnan(offset_s) ? code.add_none()
                         : code.add(static_cast<int>(std::lround(offset_s / kTimeStep_s)));
  }
  for (const std::uint16_t range : scan.range) range == 0 ? code.add_none() : code.add(range);
  return code.base64();
}

/// Its first three rows, one after another.
PageJson json_of(const Pose& pose) {
  std::vector<double> numbers;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) numbers.push_back(pose.matrix()(row, column));
  }
  return f32_block(numbers);
}

}  // namespace

PageJson drive_json(const ViewDrive& drive) {
  const SensorModel& sensor = drive.sensor;
  PageJson json = {{"columns", sensor.columns},  {"range_step_m", kRangeStep_m},
                   {"time_step_s", kTimeStep_s}, {"max_range_m", sensor.max_range_m},
                   {"rows", PageJson::array()},  {"scans", PageJson::array()}};
  for (int row = 0; row < sensor.rows(); ++row) {
    const auto beam = static_cast<std::size_t>(row);
    const double correction_rad =
        sensor.elevation_correction_rad.empty() ? 0.0 : sensor.elevation_correction_rad[beam];
    json["rows"].push_back(
        {{"elevation_rad", sensor.beam_elevation_rad[beam] + correction_rad},
         {"first_azimuth_rad", sensor.azimuth_rad(row, 0)},
         {"measured", !sensor.measured_rows || sensor.measured_rows->contains(row)}});
  }
  for (const ViewRangeImage& scan : drive.scans) {
    json["scans"].push_back({{"name", scan.name},
                             {"number", scan.number},
                             {"pose", json_of(scan.T_map_sensor)},
                             {"other", json_of(scan.T_map_other)},
                             {"other_s", scan.other_s},
                             {"columns", scan.time_offset_s.size()},
                             {"code", code_of(scan)}});
  }
  return json;
}

}  // namespace hqslam::tools

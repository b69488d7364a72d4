#include "hqslam/core/sensor_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "hqslam/core/angles.h"
#include "hqslam/core/error.h"

namespace hqslam {

namespace {

/// `value` modulo `modulus` in 0..modulus-1, for negative values too.
int wrapped(int value, int modulus) {
  const int remainder = value % modulus;
  return remainder < 0 ? remainder + modulus : remainder;
}

template <typename... Values>
void require(bool holds, const SensorModel& sensor, fmt::format_string<Values...> complaint,
             Values&&... values) {
  if (holds) return;
  throw Error("sensor '{}': {}", sensor.name,
              fmt::format(complaint, std::forward<Values>(values)...));
}

/// Corrections of all beams or of none; larger ones are another sensor, no calibration.
void require_corrections(const SensorModel& sensor) {
  constexpr double kMaxElevation_rad = 0.05;
  constexpr double kMaxRange_m = 1.0;
  const std::size_t rows = sensor.beam_elevation_rad.size();
  const std::size_t corrected = sensor.elevation_correction_rad.size();
  require((corrected == 0 || corrected == rows) && sensor.range_correction_m.size() == corrected,
          sensor,
          "{} corrections of elevation and {} of range for {} beams, expected as many or none",
          corrected, sensor.range_correction_m.size(), rows);
  for (std::size_t row = 0; row < corrected; ++row) {
    require(std::abs(sensor.elevation_correction_rad[row]) <= kMaxElevation_rad &&
                std::abs(sensor.range_correction_m[row]) <= kMaxRange_m,
            sensor, "corrections of beam {} are {} rad and {} m, expected at most {} and {}", row,
            sensor.elevation_correction_rad[row], sensor.range_correction_m[row], kMaxElevation_rad,
            kMaxRange_m);
  }
}

/// Which of the selected rows were measured, counted in the selection.
std::optional<RowSelection> measured_of(const SensorModel& sensor, RowSelection rows,
                                        const std::vector<int>& selected) {
  if (!sensor.measured_rows) return std::nullopt;
  const int count = static_cast<int>(selected.size());
  std::vector<int> measured;
  for (int i = 0; i < count; ++i) {
    if (sensor.measured_rows->contains(selected[i])) measured.push_back(i);
  }
  if (static_cast<int>(measured.size()) == count) return std::nullopt;
  if (measured.empty()) {
    const auto second = [](RowSelection r) { return std::int64_t{r.offset} + r.stride; };
    throw Error(
        "sensor '{}': rows {}, {}, ... were all computed; select some of the measured rows {}, {}, "
        "...",
        sensor.name, rows.offset, second(rows), sensor.measured_rows->offset,
        second(*sensor.measured_rows));
  }
  return RowSelection{measured.front(), measured.size() > 1 ? measured[1] - measured[0] : count};
}

}  // namespace

RowSelection selection_for(int rows, int wanted) {
  if (wanted < 1 || wanted > rows || rows % wanted != 0) {
    throw Error(
        "rows: expected a divisor of the {} rows, found {}; give one, so that they are kept evenly",
        rows, wanted);
  }
  const int stride = rows / wanted;
  return {stride - 1, stride};
}

std::vector<int> selected_rows(int rows, RowSelection selection) {
  if (selection.offset < 0 || selection.offset >= rows || selection.stride < 1) {
    throw Error(
        "row selection {}:{} does not fit {} rows: expected an offset of 0 to {} and a stride of 1 "
        "or more",
        selection.offset, selection.stride, rows, rows - 1);
  }
  std::vector<int> selected;
  // 64 bits: the row after the last may be beyond what an int holds.
  for (std::int64_t row = selection.offset; row < rows; row += selection.stride) {
    selected.push_back(static_cast<int>(row));
  }
  return selected;
}

double SensorModel::column_step_rad() const { return kTwoPi / columns; }

int SensorModel::column_shift(int row) const {
  return static_cast<int>(std::lround(beam_azimuth_offset_rad[row] / column_step_rad()));
}

double SensorModel::residual_azimuth_rad(int row) const {
  return beam_azimuth_offset_rad[row] - column_shift(row) * column_step_rad();
}

double SensorModel::azimuth_rad(int row, int column) const {
  return std::numbers::pi - (column + 0.5) * column_step_rad() + residual_azimuth_rad(row);
}

int SensorModel::firing_column(int row, int column) const {
  return wrapped(column + column_shift(row), columns);
}

int SensorModel::column_of(int row, double azimuth_rad) const {
  return column_of_azimuth(azimuth_rad - residual_azimuth_rad(row));
}

int SensorModel::column_of_azimuth(double azimuth_rad) const {
  const double turns = 0.5 - azimuth_rad / kTwoPi;
  return wrapped(static_cast<int>(std::floor((turns - std::floor(turns)) * columns)), columns);
}

void validate(const SensorModel& sensor) {
  const auto rows = sensor.beam_elevation_rad.size();
  require(rows >= 1 && rows <= 1024, sensor, "expected 1 to 1024 beams, found {}", rows);
  require(sensor.columns >= 16 && sensor.columns <= 16384, sensor,
          "columns is {}, expected 16 to 16384", sensor.columns);
  require(sensor.beam_azimuth_offset_rad.size() == rows, sensor,
          "{} azimuth offsets for {} beam elevations, expected as many",
          sensor.beam_azimuth_offset_rad.size(), rows);
  constexpr double kShortestPeriod_s = 0.001;
  constexpr double kLongestPeriod_s = 100.0;
  require(sensor.scan_period_s >= kShortestPeriod_s && sensor.scan_period_s <= kLongestPeriod_s,
          sensor, "scan_period_s is {}, expected {} to {}", sensor.scan_period_s, kShortestPeriod_s,
          kLongestPeriod_s);
  require(sensor.min_range_m >= 0.0 && sensor.max_range_m > sensor.min_range_m &&
              std::isfinite(sensor.max_range_m),
          sensor, "ranges are {} to {} m, expected 0 <= minimum < maximum", sensor.min_range_m,
          sensor.max_range_m);
  for (std::size_t row = 0; row < rows; ++row) {
    const double elevation_rad = sensor.beam_elevation_rad[row];
    require(std::abs(elevation_rad) < kTwoPi / 4.0, sensor,
            "elevation of beam {} is {} rad, expected within +-pi/2", row, elevation_rad);
    require(row == 0 || elevation_rad < sensor.beam_elevation_rad[row - 1], sensor,
            "beam {} is not below beam {}: elevations must fall from row to row", row, row - 1);
    require(std::abs(sensor.beam_azimuth_offset_rad[row]) < kTwoPi / 4.0, sensor,
            "azimuth offset of beam {} is {} rad, expected within +-pi/2", row,
            sensor.beam_azimuth_offset_rad[row]);
  }
  require_corrections(sensor);
  if (sensor.measured_rows) {
    const RowSelection measured = *sensor.measured_rows;
    require(measured.stride >= 1 && measured.offset >= 0 && measured.offset < sensor.rows(), sensor,
            "measured_rows is offset {}, stride {}, expected an offset of 0 to {} and a stride of "
            "1 or more",
            measured.offset, measured.stride, sensor.rows() - 1);
  }
}

bool have_same_beams(const SensorModel& a, const SensorModel& b) {
  const double tolerance_rad = radians(kBeamTolerance_deg);
  return std::ranges::equal(a.beam_elevation_rad, b.beam_elevation_rad,
                            [&](double x, double y) { return std::abs(x - y) <= tolerance_rad; });
}

SensorModel with_rows_between(const SensorModel& sensor, int factor) {
  if (sensor.rows() < 2 || factor < 2) {
    throw Error(
        "sensor: {} times the rows of a sensor with {}, expected twice those of two or more",
        factor, sensor.rows());
  }
  SensorModel all = sensor;
  all.name = fmt::format("{} with {} rows", sensor.name, sensor.rows() * factor);
  all.beam_elevation_rad.clear();
  all.beam_azimuth_offset_rad.clear();
  all.elevation_correction_rad.clear();
  all.range_correction_m.clear();
  for (int beam = 0; beam < sensor.rows(); ++beam) {
    const int above = std::max(beam - 1, 0);
    const double gap_rad = sensor.beam_elevation_rad[above] - sensor.beam_elevation_rad[above + 1];
    for (int below = factor - 1; below >= 0; --below) {
      all.beam_elevation_rad.push_back(sensor.beam_elevation_rad[beam] + gap_rad * below / factor);
      all.beam_azimuth_offset_rad.push_back(below == 0 ? sensor.beam_azimuth_offset_rad[beam]
                                                       : 0.0);
    }
  }
  all.measured_rows.reset();
  return all;
}

SensorModel select_rows(const SensorModel& sensor, RowSelection rows) {
  const std::vector<int> selected = selected_rows(sensor.rows(), rows);
  SensorModel result = sensor;
  result.name = fmt::format("{}/{}:{}", sensor.name, rows.offset, rows.stride);
  for (const auto list :
       {&SensorModel::beam_elevation_rad, &SensorModel::beam_azimuth_offset_rad,
        &SensorModel::elevation_correction_rad, &SensorModel::range_correction_m}) {
    if ((sensor.*list).empty()) continue;
    (result.*list).clear();
    for (const int row : selected) (result.*list).push_back((sensor.*list)[row]);
  }
  result.measured_rows = measured_of(sensor, rows, selected);
  return result;
}

}  // namespace hqslam

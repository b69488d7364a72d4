#include "calibrate/calibration_page.h"

#include <fmt/format.h>

#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "hqslam/core/angles.h"
#include "pages/page.h"

namespace hqslam::tools {
namespace {

using slam::BeamCorrection;

constexpr double kMillimetres = 1000.0;

/// A value per beam. Rows fall in elevation, and the axis of a chart rises: the last row is first.
PageJson of_beams(const CalibrationReport& report,
                  const std::function<double(const BeamCorrection&)>& value) {
  std::vector<double> values;
  for (auto beam = report.found.beams.rbegin(); beam != report.found.beams.rend(); ++beam) {
    values.push_back(value(*beam));
  }
  return f32_block(values);
}

/// A correction with one standard deviation to either side.
PageJson with_sigma(const CalibrationReport& report, double scale, double BeamCorrection::*value,
                    double BeamCorrection::*sigma) {
  const auto moved = [&](double sigmas) {
    return of_beams(report,
                    [=](const auto& b) { return scale * (b.*value + sigmas * (b.*sigma)); });
  };
  return {{"value", moved(0.0)}, {"low", moved(-1.0)}, {"high", moved(1.0)}};
}

/// Before and after the corrections.
PageJson distances_mm(const CalibrationReport& report,
                      std::optional<double> slam::BeamDistance::*distance) {
  const auto of = [&](slam::BeamDistance BeamCorrection::*when) {
    return of_beams(report, [=](const auto& b) {
      constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
      return kMillimetres * ((b.*when).*distance).value_or(kNone);
    });
  };
  return {{"before", of(&BeamCorrection::before)}, {"after", of(&BeamCorrection::after)}};
}

}  // namespace

TextTable beam_table(const CalibrationReport& report) {
  TextTable table{.columns = {"beam", "elevation deg", "added deg", "+-", "added mm", "+-",
                              "off ground mm", "after", "off walls mm", "after"}};
  for (std::size_t row = 0; row < report.found.beams.size(); ++row) {
    const BeamCorrection& beam = report.found.beams[row];
    const auto millimetres = [](std::optional<double> value_m) {
      return value_m ? fmt::format("{:.1f}", kMillimetres * *value_m) : kNoFigure;
    };
    const auto degrees = [](double value_rad) {
      return fmt::format("{:.3f}", kDegreesPerRadian * value_rad);
    };
    table.rows.push_back(
        {std::to_string(row),
         fmt::format("{:.2f}", kDegreesPerRadian * report.sensor.beam_elevation_rad[row]),
         degrees(beam.elevation_rad), degrees(beam.elevation_sigma_rad), millimetres(beam.range_m),
         millimetres(beam.range_sigma_m), millimetres(beam.before.ground_m),
         millimetres(beam.after.ground_m), millimetres(beam.before.walls_m),
         millimetres(beam.after.walls_m)});
  }
  return table;
}

std::string calibration_summary(const CalibrationReport& report) {
  return fmt::format(
      "{} scans along {:.0f} m; points are {:.1f} mm off their surfaces (RMS), {:.1f} mm "
      "after the corrections\n",
      report.scans, report.path_m, kMillimetres * report.found.residual_before_m,
      kMillimetres * report.found.residual_after_m);
}

std::string calibration_html(const CalibrationReport& report) {
  std::vector<double> elevation_deg;
  for (int row = report.sensor.rows() - 1; row >= 0; --row) {
    elevation_deg.push_back(report.sensor.beam_elevation_rad[row] * kDegreesPerRadian);
  }
  return page_html(
      "calibration",
      {{"title", "Calibration of " + report.recording},
       {"subtitle", fmt::format("{}, {} beams. {}", report.sensor.name, report.sensor.rows(),
                                calibration_summary(report))},
       {"elevation_deg", f32_block(elevation_deg)},
       {"ground_mm", distances_mm(report, &slam::BeamDistance::ground_m)},
       {"walls_mm", distances_mm(report, &slam::BeamDistance::walls_m)},
       {"elevation_correction_deg",
        with_sigma(report, kDegreesPerRadian, &BeamCorrection::elevation_rad,
                   &BeamCorrection::elevation_sigma_rad)},
       {"range_correction_mm",
        with_sigma(report, kMillimetres, &BeamCorrection::range_m, &BeamCorrection::range_sigma_m)},
       {"table", json_of(beam_table(report))}});
}

}  // namespace hqslam::tools

#include "calibrate/calibration_page.h"

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <optional>
#include <vector>

#include "hqslam/core/angles.h"
#include "report/chart.h"

namespace hqslam::tools {
namespace {

using slam::BeamCorrection;

constexpr double kMillimetres = 1000.0;

std::vector<double> of_beams(const CalibrationReport& report,
                             const std::function<double(const BeamCorrection&)>& value) {
  // Rows fall, and a chart's x rises.
  std::vector<double> values;
  for (auto beam = report.found.beams.rbegin(); beam != report.found.beams.rend(); ++beam) {
    values.push_back(value(*beam));
  }
  return values;
}

std::string chart_of(const CalibrationReport& report, const char* y_label,
                     std::vector<Series> series) {
  Chart chart;
  chart.x_label = "elevation of the beam, degrees";
  chart.y_label = y_label;
  for (int row = report.sensor.rows() - 1; row >= 0; --row) {
    chart.x.push_back(report.sensor.beam_elevation_rad[row] * kDegreesPerRadian);
  }
  chart.series = std::move(series);
  return chart_html(chart);
}

/// A value between two lines, one standard deviation to either side.
std::vector<Series> with_sigma(const CalibrationReport& report, const char* name, double scale,
                               double BeamCorrection::*value, double BeamCorrection::*sigma) {
  return {{name, "mapping", of_beams(report, [&](const auto& b) { return scale * b.*value; })},
          {"one standard deviation more", "reading",
           of_beams(report, [&](const auto& b) { return scale * (b.*value + b.*sigma); })},
          {"one less", "reading",
           of_beams(report, [&](const auto& b) { return scale * (b.*value - b.*sigma); })}};
}

/// Before and after the corrections.
std::string distances_chart(const CalibrationReport& report, const char* y_label,
                            std::optional<double> slam::BeamDistance::*distance) {
  const auto of = [&](slam::BeamDistance BeamCorrection::*when) {
    return of_beams(report, [=](const auto& b) {
      return kMillimetres * ((b.*when).*distance).value_or(std::nan(""));
    });
  };
  return chart_of(report, y_label,
                  {{"as measured", "upsampling", of(&BeamCorrection::before)},
                   {"corrected", "features", of(&BeamCorrection::after)}});
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
      "{} scans along {:.0f} m; points lie {:.1f} mm off their surfaces, {:.1f} mm after it\n",
      report.scans, report.path_m, kMillimetres * report.found.residual_before_m,
      kMillimetres * report.found.residual_after_m);
}

std::string calibration_html(const CalibrationReport& report) {
  Page page("Calibration of " + report.recording);
  page.head_html(kCalibrationPageMarker);
  page.heading(1, "Where the beams really look");
  page.paragraph(fmt::format("{}, {} of {} beams. {}", report.recording, report.sensor.name,
                             report.sensor.rows(), calibration_summary(report)));
  page.heading(2, "Rings against the ground");
  page.paragraph(
      "How far each beam's points lie above the ground that all beams see, in the mean. A beam "
      "without a value met none.");
  page.html(distances_chart(report, "above the ground, mm", &slam::BeamDistance::ground_m));
  page.heading(2, "Rings against walls");
  page.paragraph("How far they lie this side of upright surfaces.");
  page.html(distances_chart(report, "this side of walls, mm", &slam::BeamDistance::walls_m));
  page.heading(2, "Corrections");
  page.paragraph(
      "What is added to each beam's elevation and range. A beam that meets no ground says nothing "
      "about its elevation, and no drive tells errors apart that bend the whole world like a bowl: "
      "there the correction stays near zero.");
  page.html(
      chart_of(report, "elevation, degrees",
               with_sigma(report, "added to the elevation", kDegreesPerRadian,
                          &BeamCorrection::elevation_rad, &BeamCorrection::elevation_sigma_rad)));
  page.html(chart_of(report, "range, mm",
                     with_sigma(report, "added to the range", kMillimetres,
                                &BeamCorrection::range_m, &BeamCorrection::range_sigma_m)));
  page.table(beam_table(report));
  return page.text();
}

}  // namespace hqslam::tools

#include <fmt/format.h>

#include <array>

#include "hqslam/core/angles.h"
#include "hqslam/core/error.h"
#include "inspect/layers_report.h"

namespace hqslam::tools {
namespace {

std::string cell(const std::optional<double>& value, const char* format = "{:.3f}") {
  return value ? fmt::format(fmt::runtime(format), *value) : "-";
}

std::string range_text(float range_m) {
  return range_m > 0.0F ? fmt::format("{:.3f} m", range_m) : "no return";
}

}  // namespace

std::string figures_text(const LayersReport& report) {
  constexpr const char* kLine =
      "{:<24} {:>7} {:>10} {:>10} {:>12} {:>15} {:>10} {:>12} {:>12} {:>14}\n";
  std::string text = fmt::format(fmt::runtime(kLine), "", "b", "|H - Z|, m", "|H - Y|, m",
                                 "|D H - L|, m", "rejected pixels", "MAE all, m", "MAE valid, m",
                                 "wrong, share", "missing, share");
  for (const LayerFigures& f : layer_figures(report)) {
    text += fmt::format(fmt::runtime(kLine), f.name, cell(f.penalty), cell(f.rms_h_z_m),
                        cell(f.rms_h_y_m), cell(f.rms_dh_l_m),
                        f.rejected ? fmt::format("{}", *f.rejected) : "-", cell(f.error_all_m),
                        cell(f.error_valid_m), cell(f.wrong_share), cell(f.missing_share));
  }
  return text;
}

std::string pixel_text(const LayersReport& report) {
  const int row = report.pixel.at(0);
  const int column = report.pixel.at(1);
  const RangeImage& result = report.result;
  if (row < 0 || row >= result.rows || column < 0 || column >= result.columns) {
    throw Error("inspect: pixel {},{}, expected a row of 0 to {} and a column of 0 to {}", row,
                column, result.rows - 1, result.columns - 1);
  }
  const nn::Trace& trace = report.trace;
  const auto value = [&](const std::string& name) -> std::optional<double> {
    if (!trace.has(name)) return std::nullopt;
    return trace.tensor(name).values(0, row, column);
  };
  constexpr const char* kLine = "{:<8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>13} {:>8} {:>8} {:>8}\n";
  std::string text = fmt::format(
      "pixel {},{}: elevation {:.2f} degrees; {}; start {}; result {}{}\n", row, column,
      kDegreesPerRadian * report.network.sensor.beam_elevation_rad[row],
      report.network.measured_rows.contains(row) ? "measured" : "computed",
      trace.has("start") ? range_text(trace.image("start").at(row, column)) : "-",
      range_text(result.at(row, column)),
      report.truth ? fmt::format("; truth {}", range_text(report.truth->at(row, column))) : "");
  text += fmt::format(fmt::runtime(kLine), "", "H, m", "w above", "w below", "w here", "w none",
                      "correction, m", "Z, m", "rejected", "Y, m");
  for (int k = 0; k < layer_count(trace); ++k) {
    std::array<std::string, 9> cells;
    constexpr std::array<const char*, 9> kNames{
        "h",           "choice.above",   "choice.below",
        "choice.here", "choice.nothing", "choice.correction",
        "z",           "rejected",       "y"};
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const std::string name = layer_name(k, kNames[i]);
      cells[i] = cell(value(name), i == 7 ? "{:.0f}" : "{:.3f}");
    }
    text += fmt::format(fmt::runtime(kLine), fmt::format("Layer {}", k + 1), cells[0], cells[1],
                        cells[2], cells[3], cells[4], cells[5], cells[6], cells[7], cells[8]);
  }
  return text;
}

}  // namespace hqslam::tools

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <ranges>
#include <set>
#include <span>

#include "table/table_report.h"
#include "table/table_work.h"

namespace hqslam::tools {
namespace {

/// 207812 -> "208k", 35e6 -> "35.0M"
std::string count_text(double count) {
  return count >= 1e6 ? fmt::format("{:.1f}M", 1e-6 * count) : fmt::format("{:.0f}k", 1e-3 * count);
}

/// A column of a table with a row per method: a figure, if there is one, as text.
struct Column {
  std::string title;
  std::function<std::optional<double>(const TableResult&)> of;
  std::function<std::string(double)> text = three_digits;

  std::string cell(const TableResult& figures) const {
    const std::optional<double> figure = of(figures);
    return figure ? text(*figure) : kNoFigure;
  }
};

/// With this number of decimals.
auto decimals(int count) {
  return [=](double value) { return fmt::format("{:.{}f}", value, count); };
}

/// A figure of something that may not be there, or have no such figure.
template <typename Value, typename Figure>
std::optional<double> figure_of(const std::optional<Value>& value, const Figure& figure) {
  return value ? std::optional<double>(std::invoke(figure, *value)) : std::nullopt;
}

/// Those against LiDAR-64 or those against the truth.
using Errors = decltype(&TableResult::against_truth);

/// A figure of a method's errors.
template <typename Figure>
auto of_errors(Errors errors, std::size_t loop_closing, const Figure& figure) {
  return [=](const TableResult& m) { return figure_of((m.*errors)[loop_closing], figure); };
}

/// The RMSE in metres, as a share of the path, and as a share of LiDAR-16's.
void add_ape(const char* title, Errors errors, const DriveFigures& drive, std::size_t loop_closing,
             std::vector<Column>& columns) {
  using E = ErrorFigures;
  const auto rmse_m = of_errors(errors, loop_closing, &E::ape_rmse_m);
  const TableResult* few = find_method(drive, table_methods().front().name);
  const double few_m = few != nullptr ? rmse_m(*few).value_or(0.0) : 0.0;
  const auto percent = [](const E& e) {
    return e.path_m > 0.0 ? std::optional(e.ape_percent()) : std::nullopt;
  };
  const auto share = [=](const E& e) {
    return few_m > 0.0 ? std::optional(e.ape_rmse_m() / few_m) : std::nullopt;
  };
  columns.push_back({title, rmse_m});
  columns.push_back({"% of path", of_errors(errors, loop_closing, percent)});
  columns.push_back({"of LiDAR-16's", of_errors(errors, loop_closing, share), decimals(2)});
}

template <typename Methods>
TextTable table_of(const std::string& title, Methods&& methods,
                   const std::vector<Column>& columns) {
  TextTable table{.title = title, .columns = {"Method"}};
  for (const Column& column : columns) table.columns.push_back(column.title);
  for (const TableResult& figures : methods) {
    std::vector<std::string>& cells = table.rows.emplace_back();
    cells.push_back(figures.method.title);
    for (const Column& column : columns) cells.push_back(column.cell(figures));
  }
  return table;
}

/// "11.58 / 6717", one figure per drive.
std::string per_drive(std::span<const DriveFigures> drives, const TableMethod& method,
                      const Column& column) {
  std::vector<std::string> figures;
  for (const DriveFigures& drive : drives) {
    const TableResult* found = find_method(drive, method.name);
    figures.push_back(found != nullptr ? column.cell(*found) : kNoFigure);
  }
  return fmt::format("{}", fmt::join(figures, " / "));
}

std::optional<double> parameters_of(const TableResult& figures) {
  return figure_of(figures.network, &NetworkSize::parameters);
}

/// The methods of all drives, in the table's order.
std::vector<TableMethod> methods_of(const std::vector<DriveFigures>& drives) {
  std::vector<TableMethod> methods;
  for (const DriveFigures& drive : drives) {
    for (const TableResult& figures : drive.methods) {
      const auto found = std::ranges::find(methods, figures.method.name, &TableMethod::name);
      if (found == methods.end()) methods.push_back(figures.method);
    }
  }
  return methods;
}

std::string machine_text(const TableTimings& timings) {
  return fmt::format("{}, {} thread{}, {}", timings.processor, timings.threads,
                     timings.threads == 1 ? "" : "s", timings.instruction_set);
}

/// Machines, builds and weights of the results.
struct Circumstances {
  std::set<std::string> machines;
  std::set<std::string> builds;
  std::set<std::string> weights;
};

Circumstances circumstances_of(const std::vector<DriveFigures>& drives) {
  Circumstances all;
  for (const DriveFigures& drive : drives) {
    for (const TableResult& figures : drive.methods) {
      const TableSettings& settings = figures.settings;
      all.machines.insert(machine_text(figures.timings));
      all.builds.insert(settings.build);
      if (!settings.weights.empty()) {
        all.weights.insert(fmt::format("{} ({})", settings.weights, settings.weights_hash));
      }
    }
  }
  return all;
}

std::string drive_text(const DriveFigures& drive) {
  const TableResult* all = find_method(drive, table_methods().back().name);
  std::string text = fmt::format("{}: {} scans, sensor {}", drive.name, drive.scans, drive.sensor);
  if (all != nullptr) {
    text += fmt::format(", {:.0f} m of path", path_length_m(all->trajectory[kLoopClosingOff]));
  }
  if (drive.left_out.scans > 0) text += fmt::format("; {}", drive.left_out.text());
  return text + (drive.truth.empty() ? "; no true trajectory" : "");
}

std::vector<std::string> drives_notes(const std::vector<DriveFigures>& drives) {
  const Circumstances circumstances = circumstances_of(drives);
  std::vector<std::string> notes;
  notes.emplace_back(
      "APE: absolute pose error, RMSE of the position over all scans after an SE(3) alignment "
      "(least squares of all positions, no scale). Trajectory: the pose in the map of every scan. "
      "Against LiDAR-64: the trajectory of the same SLAM, with the same loop closing, with all 64 "
      "rows; it is a trajectory with errors of its own, not the truth.");
  if (find_method(drives.front(), table_methods().back().name) == nullptr) {
    notes.emplace_back(
        "No figures against LiDAR-64: rows-64 was not among the methods (--methods).");
  }
  notes.push_back(fmt::format(
      "RPE: relative pose error, RMSE over all segments of {:.0f} m, against the truth or, without "
      "it, against LiDAR-64.",
      kDriftPiece_m));
  notes.push_back(fmt::format(
      "MAE: mean |range - true range|; all pixels: no return counts as 0 m; valid: both have a "
      "return. Outliers: points farther than 0.5 m from the cloud of 64 rows. Means over at most "
      "{} scans, evenly spread. OR: the outlier filter at the end.",
      kMostScoredScans));
  notes.emplace_back(
      "Upsampling, frames/s: 1 / median time from an image of 16 rows to one of 64, measured "
      "between "
      "two runs of SLAM; hqslam-lab bench measures it alone. Whole chain: number of scans / total "
      "time from a scan of 16 rows to its pose (upsampling, points, SLAM). Reading, simulating and "
      "writing are in neither. SLAM, ms: median per scan.");
  notes.push_back(fmt::format("Made by build {} of the program, on: {}.",
                              fmt::join(circumstances.builds, ", "),
                              fmt::join(circumstances.machines, "; ")));
  if (!circumstances.weights.empty()) {
    notes.push_back(fmt::format("Weights, with the hash of the file: {}.",
                                fmt::join(circumstances.weights, ", ")));
  }
  return notes;
}

ReportPart part_of(const DriveFigures& drive) {
  ReportPart part{drive.name, drive_text(drive), {}};
  for (std::size_t i = 0; i < kLoopClosingNames.size(); ++i) {
    part.tables.push_back(trajectory_table(drive, i));
    part.error_maps.push_back(error_map_of(drive, i));
  }
  part.tables.push_back(upsampling_table(drive));
  return part;
}

}  // namespace

std::string three_digits(double value) {
  const double size = std::abs(value);
  const int decimals = size < 0.9995 ? 3 : size < 9.995 ? 2 : size < 99.95 ? 1 : 0;
  return fmt::format("{:.{}f}", value, decimals);
}

TextTable paper_table(const std::vector<DriveFigures>& drives, std::size_t loop_closing) {
  using M = TableResult;
  std::vector<std::string> names;
  for (const DriveFigures& drive : drives) names.push_back(drive.name);
  const std::vector<Column> columns = {
      {fmt::format("RMSE against LiDAR-64, m ({})", fmt::join(names, " / ")),
       of_errors(&M::against_all_rows, loop_closing, &ErrorFigures::ape_rmse_m)},
      {"upsampling, frames/s", &M::upsampling_fps},
      {"whole chain, frames/s", [=](const M& m) { return m.chain_fps(loop_closing); }}};
  const Column parameters = {"Parameters", parameters_of, count_text};
  TextTable table = table_of(fmt::format("Loop closing {}", kLoopClosingNames[loop_closing]),
                             std::views::empty<M>, columns);
  table.columns.push_back(parameters.title);
  for (const TableMethod& method : methods_of(drives)) {
    std::vector<std::string>& cells = table.rows.emplace_back();
    cells.push_back(method.title);
    for (const Column& column : columns) cells.push_back(per_drive(drives, method, column));
    cells.push_back(per_drive(std::span(drives).first(1), method, parameters));
  }
  return table;
}

TextTable trajectory_table(const DriveFigures& drive, std::size_t loop_closing) {
  using M = TableResult;
  std::vector<Column> columns;
  auto errors = &M::against_all_rows;
  add_ape("APE against LiDAR-64, m", errors, drive, loop_closing, columns);
  if (!drive.truth.empty()) {
    errors = &M::against_truth;
    add_ape("APE against the truth, m", errors, drive, loop_closing, columns);
  }
  const auto timings = [=](const M& m) { return m.timings.slam[loop_closing]; };
  columns.push_back({"RPE, %", of_errors(errors, loop_closing, &ErrorFigures::rpe_percent)});
  columns.push_back(
      {"RPE, deg/100 m", of_errors(errors, loop_closing, &ErrorFigures::rpe_deg_per_100m)});
  if (loop_closing == kLoopClosingOn) {
    columns.push_back({"loops closed", [](const M& m) { return m.loops_closed; }, decimals(0)});
  }
  columns.push_back({"whole chain, frames/s", [=](const M& m) { return m.chain_fps(loop_closing); },
                     decimals(1)});
  columns.push_back({"SLAM, ms, first 500", [=](const M& m) { return timings(m).first_ms; }});
  columns.push_back({"last 500", [=](const M& m) { return timings(m).last_ms; }});
  return table_of(fmt::format("Trajectory, loop closing {}", kLoopClosingNames[loop_closing]),
                  drive.methods, columns);
}

TextTable upsampling_table(const DriveFigures& drive) {
  using M = TableResult;
  const auto of_images = [](const auto& figure) {
    return [=](const M& m) { return figure_of(m.images, figure); };
  };
  const auto gmac = [](const NetworkSize& network) {
    return 1e-9 * static_cast<double>(network.multiply_adds);
  };
  const auto upsamples = [](const M& m) {
    return !m.method.source.empty() && m.method.variant == nullptr;
  };
  return table_of(
      "Upsampling", drive.methods | std::views::filter(upsamples),
      {{"MAE all pixels, m", of_images(&ImageScores::mae_all_m)},
       {"MAE valid, m", of_images(&ImageScores::mae_valid_m)},
       {"outliers, %", of_images([](const ImageScores& i) { return 100.0 * i.outlier_share; })},
       {"frames/s", &M::upsampling_fps},
       {"parameters", parameters_of, count_text},
       {"GMAC", [=](const M& m) { return figure_of(m.network, gmac); }}});
}

TableReport drives_report(const std::vector<DriveFigures>& drives) {
  TableReport report;
  report.title = "16 rows, 16 upsampled to 64, and 64 rows in one SLAM";
  for (std::size_t i = 0; i < kLoopClosingNames.size(); ++i) {
    report.lead.push_back(paper_table(drives, i));
  }
  for (const DriveFigures& drive : drives) report.parts.push_back(part_of(drive));
  report.notes = drives_notes(drives);
  report.json = drives_json(drives);
  return report;
}

}  // namespace hqslam::tools

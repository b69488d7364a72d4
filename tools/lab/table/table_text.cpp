#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <set>

#include "table/table_report.h"
#include "table/table_work.h"

namespace hqslam::tools {
namespace {

template <typename Value>
std::string text_or_nothing(const std::optional<Value>& value) {
  return value ? three_digits(*value) : kNoFigure;
}

/// 207812 -> "208k", 35e6 -> "35.0M"
std::string count_text(std::int64_t count) {
  const auto value = static_cast<double>(count);
  return count >= 1000000 ? fmt::format("{:.1f}M", 1e-6 * value)
                          : fmt::format("{:.0f}k", 1e-3 * value);
}

std::string parameters_text(const MethodFigures& figures) {
  const std::optional<NetworkSize>& network = figures.result.network;
  return network ? count_text(network->parameters) : kNoFigure;
}

/// Adds the RMSE in metres, as a share of the path, and as a share of LiDAR-16's.
void add_ape(std::vector<std::string>& cells, const std::optional<ErrorFigures>& error,
             const std::optional<ErrorFigures>& of_measured_rows) {
  cells.push_back(error ? three_digits(error->ape_rmse_m()) : kNoFigure);
  cells.push_back(error && error->path_m > 0.0 ? three_digits(error->ape_percent()) : kNoFigure);
  const bool has_share = error && of_measured_rows && of_measured_rows->ape_rmse_m() > 0.0;
  cells.push_back(has_share
                      ? fmt::format("{:.2f}", error->ape_rmse_m() / of_measured_rows->ape_rmse_m())
                      : kNoFigure);
}

std::vector<std::string> trajectory_cells(const DriveFigures& drive, const MethodFigures& figures,
                                          std::size_t loop_closing) {
  const MethodFigures* few = find_method(drive, table_methods().front().name);
  std::vector<std::string> cells = {figures.method.title};
  add_ape(cells, figures.against_all_rows[loop_closing],
          few != nullptr ? few->against_all_rows[loop_closing] : std::nullopt);
  const std::optional<ErrorFigures>& truth = figures.against_truth[loop_closing];
  if (!drive.truth.empty()) {
    add_ape(cells, truth, few != nullptr ? few->against_truth[loop_closing] : std::nullopt);
  }
  const std::optional<ErrorFigures>& drift =
      drive.truth.empty() ? figures.against_all_rows[loop_closing] : truth;
  cells.push_back(drift ? text_or_nothing(drift->rpe_percent()) : kNoFigure);
  cells.push_back(drift ? text_or_nothing(drift->rpe_deg_per_100m()) : kNoFigure);
  if (loop_closing == kLoopClosingOn) {
    cells.push_back(fmt::format("{}", figures.result.loops_closed));
  }
  const SlamTimings& timings = figures.result.timings.slam[loop_closing];
  cells.push_back(fmt::format("{:.1f}", figures.chain_fps(loop_closing)));
  cells.push_back(text_or_nothing(timings.first_ms));
  cells.push_back(text_or_nothing(timings.last_ms));
  return cells;
}

/// "11.58 / 6717", one figure per drive.
std::string per_drive(const std::vector<DriveFigures>& drives, const TableMethod& method,
                      const std::function<std::string(const MethodFigures&)>& text) {
  std::vector<std::string> figures;
  for (const DriveFigures& drive : drives) {
    const MethodFigures* found = find_method(drive, method.name);
    figures.push_back(found != nullptr ? text(*found) : kNoFigure);
  }
  return fmt::format("{}", fmt::join(figures, " / "));
}

/// The methods of all drives, in the table's order.
std::vector<TableMethod> methods_of(const std::vector<DriveFigures>& drives) {
  std::vector<TableMethod> methods;
  for (const DriveFigures& drive : drives) {
    for (const MethodFigures& figures : drive.methods) {
      const auto found = std::ranges::find(methods, figures.method.name, &TableMethod::name);
      if (found == methods.end()) methods.push_back(figures.method);
    }
  }
  return methods;
}

void add_columns(TextTable& table, std::initializer_list<const char*> columns) {
  table.columns.insert(table.columns.end(), columns.begin(), columns.end());
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
    for (const MethodFigures& figures : drive.methods) {
      const TableSettings& settings = figures.result.settings;
      all.machines.insert(machine_text(figures.result.timings));
      all.builds.insert(settings.build);
      if (!settings.weights.empty()) {
        all.weights.insert(fmt::format("{} ({})", settings.weights, settings.weights_hash));
      }
    }
  }
  return all;
}

}  // namespace

std::string three_digits(double value) {
  const double size = std::abs(value);
  const int decimals = size < 0.9995 ? 3 : size < 9.995 ? 2 : size < 99.95 ? 1 : 0;
  return fmt::format("{:.{}f}", value, decimals);
}

TextTable paper_table(const std::vector<DriveFigures>& drives, std::size_t loop_closing) {
  std::vector<std::string> names;
  for (const DriveFigures& drive : drives) names.push_back(drive.name);
  TextTable table;
  table.title = fmt::format("Loop closing {}", kLoopClosingNames[loop_closing]);
  table.columns = {"Method", fmt::format("RMSE against LiDAR-64, m ({})", fmt::join(names, " / ")),
                   "upsampling, frames/s", "whole chain, frames/s", "Parameters"};
  for (const TableMethod& method : methods_of(drives)) {
    table.rows.push_back({method.title,
                          per_drive(drives, method,
                                    [&](const MethodFigures& figures) {
                                      const auto& error = figures.against_all_rows[loop_closing];
                                      return error ? three_digits(error->ape_rmse_m()) : kNoFigure;
                                    }),
                          per_drive(drives, method,
                                    [](const MethodFigures& figures) {
                                      return text_or_nothing(figures.upsampling_fps());
                                    }),
                          per_drive(drives, method,
                                    [&](const MethodFigures& figures) {
                                      return three_digits(figures.chain_fps(loop_closing));
                                    }),
                          per_drive({drives.front()}, method, parameters_text)});
  }
  return table;
}

TextTable trajectory_table(const DriveFigures& drive, std::size_t loop_closing) {
  TextTable table;
  table.title = fmt::format("Trajectory, loop closing {}", kLoopClosingNames[loop_closing]);
  table.columns = {"Method", "APE against LiDAR-64, m", "% of path", "of LiDAR-16's"};
  if (!drive.truth.empty()) {
    add_columns(table, {"APE against the truth, m", "% of path", "of LiDAR-16's"});
  }
  add_columns(table, {"RPE, %", "RPE, deg/100 m"});
  if (loop_closing == kLoopClosingOn) add_columns(table, {"loops closed"});
  add_columns(table, {"whole chain, frames/s", "SLAM, ms, first 500", "last 500"});
  for (const MethodFigures& figures : drive.methods) {
    table.rows.push_back(trajectory_cells(drive, figures, loop_closing));
  }
  return table;
}

TextTable upsampling_table(const DriveFigures& drive) {
  TextTable table;
  table.title = "Upsampling";
  table.columns = {"Method",   "MAE all pixels, m", "MAE valid, m", "outliers, %",
                   "frames/s", "parameters",        "GMAC"};
  for (const MethodFigures& figures : drive.methods) {
    if (figures.method.source.empty() || figures.method.variant != nullptr) continue;
    const std::optional<ImageScores>& images = figures.result.images;
    const std::optional<NetworkSize>& network = figures.result.network;
    table.rows.push_back(
        {figures.method.title, images ? three_digits(images->mae_all_m) : kNoFigure,
         images ? three_digits(images->mae_valid_m) : kNoFigure,
         images ? three_digits(100.0 * images->outlier_share) : kNoFigure,
         text_or_nothing(figures.upsampling_fps()), parameters_text(figures),
         network ? three_digits(1e-9 * static_cast<double>(network->multiply_adds)) : kNoFigure});
  }
  return table;
}

std::string drive_text(const DriveFigures& drive) {
  const MethodFigures* all = find_method(drive, table_methods().back().name);
  std::string text = fmt::format("{}: {} scans, sensor {}", drive.name, drive.scans, drive.sensor);
  if (all != nullptr) {
    text +=
        fmt::format(", {:.0f} m of path", path_length_m(all->result.trajectory[kLoopClosingOff]));
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

}  // namespace hqslam::tools

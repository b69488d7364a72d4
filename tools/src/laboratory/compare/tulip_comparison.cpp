#include "laboratory/compare/tulip_comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "files/text_file.h"
#include "hqslam/core/error.h"
#include "hqslam/core/kitti_bin.h"
#include "hqslam/nn/upsampler.h"
#include "laboratory/compare/tulip_protocol.h"
#include "report/text_table.h"
#include "terminal/exit_status.h"
#include "terminal/interrupt.h"
#include "terminal/progress.h"
#include "terminal/terminal.h"

namespace hqslam::tools {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int kMeasuredRows = 16;

struct TulipMethod {
  std::string name;
  nn::Upsampler upsampler;
  TulipScore score;  ///< sums over the scans until they are divided
};

/// Every so many-th .bin file of a folder, or of the folder `velodyne` in it.
std::vector<fs::path> scans_of(const CompareOptions& options) {
  const fs::path inside = fs::path(options.input) / "velodyne";
  const fs::path folder = fs::is_directory(inside) ? inside : fs::path(options.input);
  std::vector<fs::path> all;
  if (fs::is_directory(folder)) {
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
      if (entry.path().extension() == ".bin") all.push_back(entry.path());
    }
  }
  if (all.empty()) {
    throw Error(
        fmt::format("{}: expected a folder with .bin files, found none; TULIP's protocol "
                    "begins with KITTI's points",
                    options.input));
  }
  std::sort(all.begin(), all.end());
  std::vector<fs::path> scans;
  for (std::size_t i = 0; i < all.size(); i += static_cast<std::size_t>(options.every)) {
    scans.push_back(all[i]);
  }
  return scans;
}

std::vector<TulipMethod> methods_of(const CompareOptions& options) {
  const SensorModel sensor = tulip_sensor();
  const RowSelection rows = selection_for(sensor.rows(), kMeasuredRows);
  std::vector<TulipMethod> methods;
  for (const std::string& name : nn::interpolation_names()) {
    methods.push_back({name, {nn::interpolation_from_name(name), sensor, rows}, {}});
  }
  for (const std::string& weights : options.weights) {
    nn::SuperResolver network = nn::SuperResolver::load(weights);
    const SensorModel& own = network.description().sensor;
    if (own.rows() != sensor.rows() || own.columns != sensor.columns ||
        network.description().measured_rows != rows) {
      throw Error(
          fmt::format("{}: lifts to {} x {} pixels; TULIP's protocol needs 64 x 1024, of "
                      "which rows 3, 7, ..., 63 are measured",
                      weights, own.rows(), own.columns));
    }
    methods.push_back({fs::path(weights).stem().string(), {std::move(network), sensor}, {}});
  }
  return methods;
}

void add(const RangeImage& truth, TulipMethod& method) {
  const RangeImage measured = select_rows(truth, method.upsampler.measured_rows());
  const TulipScore score = tulip_score(method.upsampler.run(measured).image, truth);
  method.score.mae_m += score.mae_m;
  method.score.mae_computed_m += score.mae_computed_m;
  method.score += score;
}

void make_mean(TulipScore& sum, double scans) {
  sum.mae_m /= scans;
  sum.mae_computed_m /= scans;
  sum /= scans;
}

const std::vector<Figure<TulipMethod>>& tulip_figures() {
  using M = TulipMethod;
  static const std::vector<Figure<M>> figures = {
      {"MAE all m", "mae_m", 4, 1.0, [](const M& m) { return m.score.mae_m; }},
      {"MAE computed rows m", "mae_computed_m", 4, 1.0,
       [](const M& m) { return m.score.mae_computed_m; }},
      {"Chamfer m^2", "chamfer_m2", 4, 1.0, [](const M& m) { return m.score.chamfer_m2; }},
      {"IoU", "iou", 4, 1.0, [](const M& m) { return m.score.iou; }},
      {"precision", "precision", 4, 1.0, [](const M& m) { return m.score.precision; }},
      {"recall", "recall", 4, 1.0, [](const M& m) { return m.score.recall; }},
      {"F1", "f1", 4, 1.0, [](const M& m) { return m.score.f1; }}};
  return figures;
}

}  // namespace

int compare_with_tulip(const CompareOptions& options) {
  if (!options.curve.empty()) throw Error("compare: --curve is no part of --protocol tulip");
  const InterruptGuard interrupt;
  const std::vector<fs::path> scans = scans_of(options);
  std::vector<TulipMethod> methods = methods_of(options);
  Progress progress("compare, TULIP's protocol", static_cast<std::int64_t>(scans.size()));
  std::int64_t done = 0;
  for (const fs::path& scan : scans) {
    if (interrupt.stop_requested()) break;
    const RangeImage truth = tulip_image(read_kitti_bin(scan.string()).points_m);
    for (TulipMethod& method : methods) add(truth, method);
    progress.update(++done);
  }
  progress.finish();
  if (done == 0) return kInterrupted;
  Json json = {{"written_by", kCompareJsonMarker},
               {"protocol", "tulip"},
               {"input", options.input},
               {"scans", done},
               {"methods", Json::array()}};
  for (TulipMethod& method : methods) {
    make_mean(method.score, static_cast<double>(done));
    Json& row = json["methods"].emplace_back(Json{{"method", method.name}});
    add_figures(method, tulip_figures(), row);
  }
  to_stdout("{}", markdown_of(table_of(methods, "method", tulip_figures(),
                                       [](const auto& method) { return method.name; })));
  to_stdout("{} scans of {}\n", done, options.input);
  if (!options.json.empty()) {
    write_text_file(json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n", options.json);
  }
  return interrupt.stop_requested() ? kInterrupted : kOk;
}

}  // namespace hqslam::tools

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
  TulipScore sum;
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
  method.sum.mae_m += score.mae_m;
  method.sum.mae_computed_m += score.mae_computed_m;
  method.sum += score;
}

TulipScore mean_of(TulipScore sum, double scans) {
  sum.mae_m /= scans;
  sum.mae_computed_m /= scans;
  sum /= scans;
  return sum;
}

Json json_of(const std::string& name, const TulipScore& s) {
  return {{"method", name},
          {"mae_m", s.mae_m},
          {"mae_computed_m", s.mae_computed_m},
          {"chamfer_m2", s.chamfer_m2},
          {"iou", s.iou},
          {"precision", s.precision},
          {"recall", s.recall},
          {"f1", s.f1}};
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
  to_stdout(
      "| method | MAE all m | MAE computed rows m | Chamfer m^2 | IoU | precision | recall | "
      "F1 |\n|--|--|--|--|--|--|--|--|\n");
  Json json = {{"written_by", kCompareJsonMarker},
               {"protocol", "tulip"},
               {"input", options.input},
               {"scans", done},
               {"methods", Json::array()}};
  for (const TulipMethod& method : methods) {
    const TulipScore s = mean_of(method.sum, static_cast<double>(done));
    to_stdout("| {} | {:.4f} | {:.4f} | {:.4f} | {:.4f} | {:.4f} | {:.4f} | {:.4f} |\n",
              method.name, s.mae_m, s.mae_computed_m, s.chamfer_m2, s.iou, s.precision, s.recall,
              s.f1);
    json["methods"].push_back(json_of(method.name, s));
  }
  to_stdout("{} scans of {}\n", done, options.input);
  if (!options.json.empty()) {
    write_text_file(json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n", options.json);
  }
  return interrupt.stop_requested() ? kInterrupted : kOk;
}

}  // namespace hqslam::tools

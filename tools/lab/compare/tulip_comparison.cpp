#include "compare/tulip_comparison.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "compare/upsampling_comparison.h"
#include "files/result_files.h"
#include "hqslam/core/angles.h"
#include "hqslam/core/error.h"
#include "hqslam/core/kitti_bin.h"
#include "hqslam/evaluation/image_error.h"
#include "hqslam/nn/compare/compared_networks.h"
#include "hqslam/nn/upsampler.h"
#include "report/page.h"
#include "terminal/progress.h"
#include "terminal/terminal.h"

namespace hqslam::tools {
namespace {

constexpr int kRows = 64;
constexpr int kColumns = 1024;
constexpr int kTulipMeasuredRows = 16;
constexpr double kLowest_deg = -24.8;
constexpr double kRowStep_deg = 26.8 / (kRows - 1);
constexpr double kColumnStep_deg = 360.0 / kColumns;
constexpr double kMaxRange_m = 120.0;
constexpr float kMinPrediction_m = 2.0F;
constexpr float kMaxPrediction_m = 80.0F;

/// TULIP's column of ours and ours of TULIP's: the circle turned over, forward stays at 512.
int mirrored(int column) { return (kColumns - column) % kColumns; }

bool is_measured(int row) { return selection_for(kRows, kTulipMeasuredRows).contains(row); }

double mae_of_computed_rows_m(const RangeImage& image, const RangeImage& truth) {
  double sum_m = 0.0;
  for (int row = 0; row < kRows; ++row) {
    if (is_measured(row)) continue;
    for (int column = 0; column < kColumns; ++column) {
      sum_m += std::abs(image.at(row, column) - truth.at(row, column));
    }
  }
  return sum_m / ((kRows - kTulipMeasuredRows) * kColumns);
}

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// With sums over the scans until they are divided.
struct TulipMethod : TulipScore {
  std::string name;
  nn::Upsampler upsampler;
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
        "{}: expected a folder with .bin files, found none; TULIP's protocol begins with KITTI's "
        "points",
        options.input);
  }
  std::ranges::sort(all);
  std::vector<fs::path> scans;
  for (std::size_t i = 0; i < all.size(); i += static_cast<std::size_t>(options.every)) {
    scans.push_back(all[i]);
  }
  return scans;
}

std::vector<TulipMethod> methods_of(const CompareOptions& options) {
  const SensorModel sensor = tulip_sensor();
  const RowSelection rows = selection_for(sensor.rows(), kTulipMeasuredRows);
  std::vector<TulipMethod> methods;
  for (const std::string& name : nn::interpolation_names()) {
    methods.push_back({{}, name, {nn::interpolation_from_name(name), sensor, rows}});
  }
  for (const std::string& weights : options.weights) {
    nn::SuperResolver network =
        nn::SuperResolver::load(weights, {.architectures = nn::all_architectures()});
    const SensorModel& own = network.description().sensor;
    if (own.rows() != sensor.rows() || own.columns != sensor.columns ||
        network.description().measured_rows != rows) {
      throw Error(
          "{}: upsamples to {} x {} pixels; TULIP's protocol needs 64 x 1024, of which rows 3, 7, "
          "..., "
          "63 are measured",
          weights, own.rows(), own.columns);
    }
    methods.push_back({{}, short_name(weights, options.weights), {std::move(network), sensor}});
  }
  return methods;
}

void add(const RangeImage& truth, TulipMethod& method) {
  const RangeImage measured = select_rows(truth, method.upsampler.measured_rows());
  const TulipScore score = tulip_score(method.upsampler.run(measured).image, truth);
  method.mae_m += score.mae_m;
  method.mae_computed_m += score.mae_computed_m;
  method += score;
}

void make_mean(TulipScore& sum, double scans) {
  sum.mae_m /= scans;
  sum.mae_computed_m /= scans;
  sum /= scans;
}

const std::vector<Figure<TulipMethod>>& tulip_figures() {
  using M = TulipMethod;
  static const std::vector<Figure<M>> figures = {
      {"MAE all m", "mae_m", 4, 1.0, &M::mae_m},
      {"MAE computed rows m", "mae_computed_m", 4, 1.0, &M::mae_computed_m},
      {"Chamfer m^2", "chamfer_m2", 4, 1.0, &M::chamfer_m2},
      {"IoU", "iou", 4, 1.0, &M::iou},
      {"precision", "precision", 4, 1.0, &M::precision},
      {"recall", "recall", 4, 1.0, &M::recall},
      {"F1", "f1", 4, 1.0, &M::f1}};
  return figures;
}

}  // namespace

SensorModel tulip_sensor() {
  SensorModel sensor;
  sensor.name = "tulip-kitti";
  sensor.columns = kColumns;
  sensor.max_range_m = kMaxRange_m;
  for (int row = 0; row < kRows; ++row) {
    sensor.beam_elevation_rad.push_back((kLowest_deg + kRowStep_deg * (kRows - 1 - row)) *
                                        kDegree_rad);
    sensor.beam_azimuth_offset_rad.push_back(0.0);
  }
  return sensor;
}

RangeImage tulip_image(const std::vector<Eigen::Vector3f>& points_m) {
  RangeImage image(kRows, kColumns);
  for (const Eigen::Vector3f& p : points_m) {
    const double range_m = p.cast<double>().norm();
    const double elevation_deg = std::atan2(p.z(), std::hypot(p.x(), p.y())) / kDegree_rad;
    const double from_below = std::round((elevation_deg - kLowest_deg) / kRowStep_deg);
    if (!(from_below >= 0.0 && from_below < kRows)) continue;
    const double azimuth_deg = std::atan2(p.x(), p.y()) / kDegree_rad;
    const int column = kColumns / 2 - static_cast<int>((azimuth_deg - 90.0) / kColumnStep_deg);
    const int wrapped = (column % kColumns + kColumns) % kColumns;
    image.at(kRows - 1 - static_cast<int>(from_below), mirrored(wrapped)) =
        range_m > kMaxRange_m ? 0.0F : static_cast<float>(range_m);
  }
  return image;
}

std::vector<Eigen::Vector3f> tulip_points_m(const RangeImage& image) {
  std::vector<Eigen::Vector3f> points_m;
  points_m.reserve(image.range_m.size());
  for (int row = 0; row < image.rows; ++row) {
    const double elevation_rad = (kLowest_deg + kRowStep_deg * (kRows - 1 - row)) * kDegree_rad;
    for (int column = 0; column < image.columns; ++column) {
      const int from_ahead = kColumns / 2 - (mirrored(column) + 1);
      const double azimuth_rad = (90.0 + from_ahead * kColumnStep_deg) * kDegree_rad;
      const double range_m = image.at(row, column);
      points_m.emplace_back(
          static_cast<float>(range_m * std::cos(elevation_rad) * std::sin(azimuth_rad)),
          static_cast<float>(range_m * std::cos(elevation_rad) * std::cos(azimuth_rad)),
          static_cast<float>(range_m * std::sin(elevation_rad)));
    }
  }
  return points_m;
}

TulipScore tulip_score(RangeImage upsampled, const RangeImage& truth) {
  for (float& range_m : upsampled.range_m) {
    if (!(range_m >= kMinPrediction_m && range_m <= kMaxPrediction_m)) range_m = 0.0F;
  }
  TulipScore score;
  score.mae_m = image_error(upsampled, truth).mae_all_m;
  score.mae_computed_m = mae_of_computed_rows_m(upsampled, truth);
  for (int row = 0; row < kRows; ++row) {
    if (!is_measured(row)) continue;
    for (int column = 0; column < kColumns; ++column) {
      upsampled.at(row, column) = truth.at(row, column);
    }
  }
  static_cast<CloudError&>(score) = cloud_error(tulip_points_m(upsampled), tulip_points_m(truth));
  return score;
}

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
  Json json = {{"written_by", "hqslam-lab compare"},
               {"protocol", "tulip"},
               {"input", options.input},
               {"scans", done},
               {"methods", Json::array()}};
  for (TulipMethod& method : methods) {
    make_mean(method, static_cast<double>(done));
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

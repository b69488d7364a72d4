#include "compare/upsampling_comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <utility>

#include "hqslam/evaluation/trajectory_error.h"
#include "hqslam/nn/trace.h"
#include "hqslam/nn/upsampled_cloud.h"
#include "timing/timing.h"

namespace hqslam::tools {

namespace fs = std::filesystem;

namespace {

/// An image or a cloud with its measured rows emptied.
template <typename Pixels>
Pixels computed_rows(Pixels scan, RowSelection measured) {
  for (std::size_t pixel = 0; pixel < scan.range_m.size(); ++pixel) {
    if (measured.contains(static_cast<int>(pixel) / scan.columns)) scan.range_m[pixel] = 0.0F;
  }
  return scan;
}

/// Z where a return is likelier than none.
RangeImage likely(const nn::Trace& trace, int k) {
  RangeImage z = trace.image(fmt::format("layers.{}.z", k));
  const std::span<const float> probability = trace.tensor("probability").all();
  for (std::size_t i = 0; i < probability.size(); ++i) {
    if (probability[i] < 0.5F) z.range_m[i] = 0.0F;
  }
  return z;
}

}  // namespace

void add_errors(const nn::UpsampledImage& upsampled, const OrganizedCloud& measured,
                const OrganizedCloud& truth, const SensorModel& sensor, UpsamplingScore& sum) {
  const RowSelection rows = *sensor.measured_rows;
  const RangeImage& image = upsampled.image;
  const OrganizedCloud cloud = nn::upsampled_cloud(upsampled, measured, rows, sensor);
  const std::vector<Eigen::Vector3f> points_m = points_of(cloud);
  const CloudError cloud_errors = cloud_error(points_m, points_of(truth));
  const ImageError image_errors = image_error(image, range_image(truth));
  sum += cloud_errors;
  sum.mae_all_m += image_errors.mae_all_m;
  sum.mae_valid_m += image_errors.mae_valid_m;
  const ImageError computed =
      image_error(computed_rows(image, rows), computed_rows(range_image(truth), rows));
  sum.missing_share += computed.missing_share;
  sum.invented_share += computed.invented_share;
  sum.right_share += computed.right_share;
  const std::vector<Eigen::Vector3f> computed_m = points_of(computed_rows(cloud, rows));
  const std::vector<Eigen::Vector3f> true_m = points_of(computed_rows(truth, rows));
  if (!computed_m.empty() && !true_m.empty()) {
    sum.computed_f1 += voxel_overlap(computed_m, true_m).f1;
  }
  sum.outliers_per_scan += cloud_errors.outlier_share * static_cast<double>(points_m.size());
}

void make_mean(UpsamplingScore& sum, std::int64_t scans) {
  const double n = static_cast<double>(scans);
  sum /= n;
  for (double* mean : {&sum.mae_all_m, &sum.mae_valid_m, &sum.missing_share, &sum.invented_share,
                       &sum.right_share, &sum.computed_f1, &sum.outliers_per_scan}) {
    *mean /= n;
  }
}

std::string short_name(const std::string& weights, const std::vector<std::string>& all) {
  const auto stem = [](const fs::path& path) { return path.stem().string(); };
  return std::ranges::count(all, stem(weights), stem) == 1 ? stem(weights) : weights;
}

UpsamplingComparison::UpsamplingComparison(std::vector<ComparedMethod> methods)
    : methods_(std::move(methods)), sums_(methods_.size()) {}

const nn::Upsampler* UpsamplingComparison::with_memory() const {
  for (const ComparedMethod& method : methods_) {
    if (method.upsampler.has_scan_memory()) return &method.upsampler;
  }
  return nullptr;
}

void UpsamplingComparison::add(const OrganizedCloud& truth, const nn::RecalledImage& recalled) {
  for (std::size_t i = 0; i < methods_.size(); ++i) add(methods_[i], truth, recalled, sums_[i]);
  ++scans_;
}

void UpsamplingComparison::add(ComparedMethod& method, const OrganizedCloud& truth,
                               const nn::RecalledImage& recalled, Sums& sums) const {
  const RowSelection rows = method.upsampler.measured_rows();
  const OrganizedCloud measured = select_rows(truth, rows);
  const RangeImage measured_image = range_image(measured);
  nn::UpsampledImage upsampled;
  sums.times_ms.push_back(
      1e3 * seconds_of([&] { upsampled = method.upsampler.run(measured_image, recalled); }));
  add_errors(upsampled, measured, truth, method.upsampler.sensor(), sums.sum);
}

std::vector<UpsamplingScore> UpsamplingComparison::scores() const {
  std::vector<UpsamplingScore> scores;
  for (std::size_t i = 0; i < methods_.size(); ++i) {
    const Sums& sums = sums_[i];
    UpsamplingScore score = sums.sum;
    score.method = methods_[i].name;
    make_mean(score, scans_);
    score.upsampling_ms = statistics_of(sums.times_ms).median;
    scores.push_back(score);
  }
  return scores;
}

LayerComparison::LayerComparison(nn::SuperResolver network, const SensorModel& sensor)
    : network_(std::move(network)),
      linear_(nn::interpolation_from_name("linear"), sensor, network_.description().measured_rows) {
}

RangeImage LayerComparison::restored(RangeImage image, const RangeImage& measured) const {
  const SensorModel& sensor = network_.sensor();
  for (float& range_m : image.range_m) {
    if (range_m < sensor.min_range_m || range_m > sensor.max_range_m) range_m = 0.0F;
  }
  const RowSelection rows = linear_.measured_rows();
  for (int row = 0; row < measured.rows; ++row) {
    for (int column = 0; column < measured.columns; ++column) {
      image.at(rows.offset + row * rows.stride, column) = measured.at(row, column);
    }
  }
  return image;
}

std::vector<LayerComparison::Step> LayerComparison::steps(const RangeImage& measured) {
  nn::Trace trace;
  RangeImage result = network_.run(measured, &trace).image;
  std::vector<Step> steps = {{"linear", linear_.run(measured).image}};
  const std::array<std::pair<const char*, const char*>, 3> iterates{
      {{"H", "h"}, {"Z", "z"}, {"Y", "y"}}};
  for (int k = 0; trace.has(fmt::format("layers.{}.z", k)); ++k) {
    const auto add = [&](const char* iterate, const RangeImage& image) {
      steps.push_back({fmt::format("layer {}: {}", k + 1, iterate), restored(image, measured)});
    };
    if (trace.has("probability")) {
      add("Z where p >= 0.5", likely(trace, k));
      continue;
    }
    for (const auto& [iterate, name] : iterates) {
      const std::string tensor = fmt::format("layers.{}.{}", k, name);
      if (trace.has(tensor)) add(iterate, trace.image(tensor));
    }
  }
  steps.push_back({"result", std::move(result)});
  return steps;
}

void LayerComparison::add(const OrganizedCloud& truth) {
  const OrganizedCloud measured = select_rows(truth, linear_.measured_rows());
  std::vector<Step> of_scan = steps(range_image(measured));
  sums_.resize(of_scan.size());
  for (std::size_t i = 0; i < of_scan.size(); ++i) {
    sums_[i].method = std::move(of_scan[i].name);
    add_errors({std::move(of_scan[i].image), {}}, measured, truth, linear_.sensor(), sums_[i]);
  }
  ++scans_;
}

std::vector<UpsamplingScore> LayerComparison::scores() const {
  std::vector<UpsamplingScore> scores = sums_;
  for (UpsamplingScore& score : scores) make_mean(score, scans_);
  return scores;
}

}  // namespace hqslam::tools

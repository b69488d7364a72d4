#include "compare/confidence_curve.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hqslam/core/error.h"
#include "hqslam/evaluation/cloud_error.h"
#include "hqslam/evaluation/image_error.h"
#include "hqslam/nn/upsampled_cloud.h"
#include "report/chart.h"

namespace hqslam::tools {

namespace {

constexpr int kBins = 10;

std::vector<OperatingPoint> operating_points() {
  std::vector<OperatingPoint> points;
  for (const double confidence :
       {0.0, 0.02, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95}) {
    points.push_back({.least_confidence = confidence});
  }
  return points;
}

/// Everything about one upsampled scan that the operating points share.
struct UpsampledScan {
  nn::UpsampledImage upsampled;
  OrganizedCloud cloud;
  std::vector<float> distance_m;  ///< of each pixel's point to the true cloud; 0 without a return
};

std::vector<Eigen::Vector3f> points_of(const OrganizedCloud& cloud, const RangeImage& image) {
  std::vector<Eigen::Vector3f> points_m;
  for (std::size_t i = 0; i < cloud.points_m.size(); ++i) {
    if (image.range_m[i] > 0.0F) points_m.push_back(cloud.points_m[i]);
  }
  return points_m;
}

void add_point(const UpsampledScan& scan, const OrganizedCloud& truth, RowSelection measured,
               OperatingPoint& sum) {
  RangeImage image = scan.upsampled.image;
  const RangeImage true_image = range_image(truth);
  std::int64_t points = 0;
  std::int64_t outliers = 0;
  std::int64_t missing = 0;
  std::int64_t true_returns = 0;
  for (std::size_t i = 0; i < image.range_m.size(); ++i) {
    const bool computed = !measured.contains(static_cast<int>(i) / image.columns);
    if (computed && scan.upsampled.confidence[i] < sum.least_confidence) image.range_m[i] = 0.0F;
    if (computed && true_image.range_m[i] > 0.0F) {
      ++true_returns;
      if (image.range_m[i] <= 0.0F) ++missing;
    }
    if (image.range_m[i] <= 0.0F) continue;
    ++points;
    if (scan.distance_m[i] > kOutlierDistance_m) ++outliers;
  }
  const ImageError error = image_error(image, true_image);
  sum.mae_all_m += error.mae_all_m;
  sum.mae_valid_m += error.mae_valid_m;
  sum.outlier_share += static_cast<double>(outliers) / static_cast<double>(points);
  sum.missing_share +=
      static_cast<double>(missing) / static_cast<double>(std::max<std::int64_t>(1, true_returns));
  sum.f1 += voxel_overlap(points_of(scan.cloud, image), points_of(truth, true_image)).f1;
}

void add_reliability(const nn::UpsampledImage& upsampled, const OrganizedCloud& truth,
                     RowSelection measured, float tolerance_m, std::vector<ReliabilityBin>& bins) {
  for (std::size_t i = 0; i < upsampled.confidence.size(); ++i) {
    if (measured.contains(static_cast<int>(i) / truth.columns)) continue;
    const double confidence = upsampled.confidence[i];
    const bool right = truth.range_m[i] > 0.0F &&
                       std::fabs(upsampled.image.range_m[i] - truth.range_m[i]) <= tolerance_m;
    ReliabilityBin& bin = bins[std::min(static_cast<int>(confidence * kBins), kBins - 1)];
    bin.confidence += confidence;
    bin.right_share += right ? 1.0 : 0.0;
    ++bin.pixels;
  }
}

/// A point per row: of what `x` says the figures that `series` says.
template <typename Row>
struct Line {
  const char* name;
  const char* css_class;
  double Row::*y;
};
template <typename Row>
std::string lines_html(const std::vector<Row>& rows, double Row::*x, const char* x_label,
                       const char* y_label, const std::vector<Line<Row>>& lines) {
  Chart chart{x_label, y_label, {}, {}};
  for (const Row& row : rows) chart.x.push_back(row.*x);
  for (const Line<Row>& line : lines) {
    Series& series = chart.series.emplace_back(Series{line.name, line.css_class, {}});
    for (const Row& row : rows) series.y.push_back(row.*line.y);
  }
  return chart_html(chart);
}

}  // namespace

ConfidenceCurve::ConfidenceCurve(nn::Upsampler network, float tolerance_m)
    : network_(std::move(network)),
      tolerance_m_(tolerance_m),
      sums_(operating_points()),
      bin_sums_(kBins) {
  if (network_.network() == nullptr || !has_confidence(network_.network()->description())) {
    throw Error("compare: a confidence curve of " + network_.name() +
                ", which has no confidence; name weights of kind du-mix");
  }
}

void ConfidenceCurve::add(const OrganizedCloud& truth, const nn::RecalledImage& recalled) {
  const RowSelection rows = network_.measured_rows();
  const OrganizedCloud measured = select_rows(truth, rows);
  UpsampledScan scan{network_.run(range_image(measured), recalled), {}, {}};
  scan.cloud = nn::upsampled_cloud(scan.upsampled, measured, rows, network_.sensor());
  const std::vector<float> distances_m = nearest_distances_m(
      points_of(scan.cloud, scan.upsampled.image), points_of(truth, range_image(truth)));
  std::size_t next = 0;
  for (const float range_m : scan.upsampled.image.range_m) {
    scan.distance_m.push_back(range_m > 0.0F ? distances_m[next++] : 0.0F);
  }
  for (OperatingPoint& sum : sums_) add_point(scan, truth, rows, sum);
  add_reliability(scan.upsampled, truth, rows, tolerance_m_, bin_sums_);
  ++scans_;
}

std::vector<OperatingPoint> ConfidenceCurve::points() const {
  std::vector<OperatingPoint> points = sums_;
  for (OperatingPoint& point : points) {
    for (double* mean : {&point.mae_all_m, &point.mae_valid_m, &point.outlier_share,
                         &point.missing_share, &point.f1}) {
      *mean /= static_cast<double>(std::max<std::int64_t>(1, scans_));
    }
  }
  return points;
}

std::vector<ReliabilityBin> ConfidenceCurve::reliability() const {
  std::vector<ReliabilityBin> bins;
  for (const ReliabilityBin& sum : bin_sums_) {
    if (sum.pixels == 0) continue;
    const auto pixels = static_cast<double>(sum.pixels);
    bins.push_back({sum.confidence / pixels, sum.right_share / pixels, sum.pixels});
  }
  return bins;
}

double ConfidenceCurve::calibration_error() const {
  double sum = 0.0;
  std::int64_t pixels = 0;
  for (const ReliabilityBin& bin : reliability()) {
    sum += std::fabs(bin.confidence - bin.right_share) * static_cast<double>(bin.pixels);
    pixels += bin.pixels;
  }
  return pixels > 0 ? sum / static_cast<double>(pixels) : 0.0;
}

const std::vector<Figure<OperatingPoint>>& operating_figures() {
  using P = OperatingPoint;
  static const std::vector<Figure<P>> figures = {
      {"MAE all m", "mae_all_m", 3, 1.0, &P::mae_all_m},
      {"MAE valid m", "mae_valid_m", 3, 1.0, &P::mae_valid_m},
      {"outliers %", "outlier_share", 2, 100.0, &P::outlier_share},
      {"missing %", "missing_share", 2, 100.0, &P::missing_share},
      {"F1", "f1", 3, 1.0, &P::f1}};
  return figures;
}

TextTable operating_table(const std::vector<OperatingPoint>& points) {
  return table_of(points, "confidence", operating_figures(), [](const OperatingPoint& point) {
    return figure_text(point.least_confidence, 2);
  });
}

std::string confidence_html(const ConfidenceCurve& curve, const std::string& weights,
                            const std::string& recording) {
  const std::vector<OperatingPoint> points = curve.points();
  const std::vector<ReliabilityBin> reliability = curve.reliability();
  Page page("Confidence of " + weights);
  page.head_html(kConfidencePageMarker);
  page.heading(1, "How sure the network is, and how right");
  page.paragraph(fmt::format("{}, {} scans of {}", weights, curve.scans(), recording));
  page.heading(2, "Every operating point");
  page.html(lines_html<OperatingPoint>(
      points, &OperatingPoint::least_confidence, "confidence below which pixels are emptied",
      "share",
      {{"outliers among the points", "upsampling", &OperatingPoint::outlier_share},
       {"true returns missing", "segmentation", &OperatingPoint::missing_share},
       {"F1 of voxels of 0.1 m", "features", &OperatingPoint::f1}}));
  page.table(operating_table(points));
  page.heading(2, "Can it be believed?");
  page.paragraph(fmt::format(
      "Computed pixels by tenths of their confidence: how many have their true return within {:g} "
      "m. Mean distance from the diagonal: {:.3f}",
      curve.tolerance_m(), curve.calibration_error()));
  if (reliability.size() > 1) {
    page.html(lines_html<ReliabilityBin>(
        reliability, &ReliabilityBin::confidence, "confidence said", "share that was right",
        {{"what would be true", "reading", &ReliabilityBin::confidence},
         {"what is true", "odometry", &ReliabilityBin::right_share}}));
  }
  return page.text();
}

}  // namespace hqslam::tools

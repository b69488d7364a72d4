#include "feature_extraction.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace hqslam::lego_loam {

namespace {

constexpr int kWindow = 5;  // points on either side
constexpr int kSections = 6;
constexpr int kSharp = 2;
constexpr int kLessSharp = 20;
constexpr int kFlat = 4;
constexpr float kSmoothness_m2 = 0.1F;
constexpr float kJump_m = 0.3F;
constexpr float kGrazing = 0.02F;  // of the range
constexpr int kMaxColumnGap = 10;
constexpr float kLessFlatLeaf_m = 0.2F;

/// The features of one row.
class Row {
 public:
  explicit Row(const std::vector<SegmentedPoint>& points)
      : points_(points),
        size_(static_cast<int>(points.size())),
        smoothness_m2_(points.size(), 0.0F),
        passed_over_(points.size(), 0),
        kind_(points.size(), FeatureKind::kNone) {
    for (int i = kWindow; i < size_ - kWindow; ++i) smoothness_m2_[i] = smoothness_m2(i);
    for (int i = kWindow; i < size_ - kWindow; ++i) pass_over_unreliable(i);
  }

  std::vector<FeatureKind> choose() {
    const int usable = size_ - 2 * kWindow;
    for (int section = 0; section < kSections && usable > 0; ++section) {
      choose_in_section(kWindow + usable * section / kSections,
                        kWindow + usable * (section + 1) / kSections);
    }
    return kind_;
  }

 private:
  float smoothness_m2(int i) const {
    float sum_m = 0.0F;
    for (int j = i - kWindow; j <= i + kWindow; ++j) sum_m += points_[j].range_m;
    sum_m -= (2 * kWindow + 1) * points_[i].range_m;
    return sum_m * sum_m;
  }

  void pass_over(int first, int last) {
    for (int i = std::max(first, 0); i <= std::min(last, size_ - 1); ++i) passed_over_[i] = 1;
  }

  int column_gap(int i, int j) const { return std::abs(points_[i].column - points_[j].column); }

  void pass_over_unreliable(int i) {
    const float here_m = points_[i].range_m;
    const float next_m = points_[i + 1].range_m;
    if (column_gap(i, i + 1) < kMaxColumnGap) {
      if (here_m - next_m > kJump_m) pass_over(i - kWindow, i);
      if (next_m - here_m > kJump_m) pass_over(i + 1, i + 1 + kWindow);
    }
    const float least_m =
        std::min(std::abs(points_[i - 1].range_m - here_m), std::abs(next_m - here_m));
    if (least_m > kGrazing * here_m) passed_over_[i] = 1;
  }

  void pass_over_neighbours(int i) {
    passed_over_[i] = 1;
    for (const int step : {1, -1}) {
      for (int j = i + step; std::abs(j - i) <= kWindow && j >= 0 && j < size_; j += step) {
        if (column_gap(j, j - step) > kMaxColumnGap) break;
        passed_over_[j] = 1;
      }
    }
  }

  void choose_in_section(int first, int end) {
    std::vector<int> order(end - first);
    std::iota(order.begin(), order.end(), first);
    std::stable_sort(order.begin(), order.end(),
                     [&](int a, int b) { return smoothness_m2_[a] < smoothness_m2_[b]; });
    int edges = 0;
    for (auto i = order.rbegin(); i != order.rend() && edges < kLessSharp; ++i) {
      if (smoothness_m2_[*i] <= kSmoothness_m2) break;
      if (passed_over_[*i] != 0 || points_[*i].ground) continue;
      kind_[*i] = edges++ < kSharp ? FeatureKind::kSharp : FeatureKind::kLessSharp;
      pass_over_neighbours(*i);
    }
    int flat = 0;
    for (auto i = order.begin(); i != order.end() && flat < kFlat; ++i) {
      if (smoothness_m2_[*i] >= kSmoothness_m2) break;
      if (passed_over_[*i] != 0 || !points_[*i].ground) continue;
      kind_[*i] = FeatureKind::kFlat;
      ++flat;
      pass_over_neighbours(*i);
    }
    for (int i = first; i < end; ++i) {
      if (kind_[i] == FeatureKind::kNone) kind_[i] = FeatureKind::kLessFlat;
    }
  }

  const std::vector<SegmentedPoint>& points_;
  int size_;
  std::vector<float> smoothness_m2_;
  std::vector<std::uint8_t> passed_over_;
  std::vector<FeatureKind> kind_;
};

}  // namespace

Features extract_features(const SegmentedScan& scan, int columns) {
  Features features;
  features.kind.assign(scan.label.size(), FeatureKind::kNone);
  for (std::size_t row = 0; row < scan.rows.size(); ++row) {
    const std::vector<FeatureKind> kind = Row(scan.rows[row]).choose();
    Cloud ground;
    Cloud cluster;
    for (std::size_t i = 0; i < kind.size(); ++i) {
      const SegmentedPoint& point = scan.rows[row][i];
      features.kind[row * columns + point.column] = kind[i];
      if (kind[i] == FeatureKind::kSharp) features.sharp.push_back(point.point);
      if (kind[i] == FeatureKind::kFlat) features.flat.push_back(point.point);
      if (kind[i] == FeatureKind::kSharp || kind[i] == FeatureKind::kLessSharp) {
        features.less_sharp.push_back(point.point);
      } else if (kind[i] != FeatureKind::kNone) {
        (point.ground ? ground : cluster).push_back(point.point);
      }
    }
    features.less_flat_ground += thinned(ground, kLessFlatLeaf_m);
    features.less_flat_cluster += thinned(cluster, kLessFlatLeaf_m);
  }
  return features;
}

}  // namespace hqslam::lego_loam

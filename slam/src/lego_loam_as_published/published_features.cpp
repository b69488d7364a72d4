#include "published_features.h"

#include <algorithm>
#include <cstdint>
#include <numeric>

#include "front_end/row_ranges.h"
#include "front_end/voxel_thinning.h"

namespace hqslam::slam::as_published {

namespace {

constexpr int kSections = 6;
constexpr int kMaxColumnGap = 9;  // between a jump's two sides
constexpr int kSharpPerSection = 2;
constexpr int kLessSharpPerSection = 20;
constexpr int kFlatPerSection = 4;
constexpr float kThreshold_m2 = 0.1F;
constexpr double kLessFlatLeaf_m = 0.2;

class Selection {
 public:
  explicit Selection(const SegmentedScan& scan)
      : scan_(scan),
        smoothness_m2_(scan.points.size(), 0.0F),
        passed_over_(scan.points.size(), 0),
        is_edge_(scan.points.size(), 0),
        order_(scan.points.size()) {
    std::iota(order_.begin(), order_.end(), 0);
    for (const SegmentedPoint& point : scan.points) {
      ranges_.range_m.push_back(point.range_m);
      ranges_.column.push_back(point.column);
    }
    for (int i = RowRanges::kHalfWindow; i + RowRanges::kHalfWindow < ranges_.size(); ++i) {
      const float smoothness_m = ranges_.smoothness_at_m(i);
      smoothness_m2_[i] = smoothness_m * smoothness_m;
    }
    ranges_.mark_unreliable(kMaxColumnGap, passed_over_);
  }

  PublishedFeatures choose() {
    for (std::size_t row = 0; row < scan_.first.size(); ++row) {
      std::vector<FeaturePoint> less_flat;
      for (int section = 0; section < kSections; ++section) {
        const int first =
            (scan_.first[row] * (kSections - section) + scan_.last[row] * section) / kSections;
        const int last =
            (scan_.first[row] * (kSections - 1 - section) + scan_.last[row] * (section + 1)) /
                kSections -
            1;
        if (first >= last || first < 0) continue;
        choose_in_section(first, last, less_flat);
      }
      const std::vector<FeaturePoint> thinned = thin(less_flat, kLessFlatLeaf_m);
      features_.less_flat.insert(features_.less_flat.end(), thinned.begin(), thinned.end());
    }
    return std::move(features_);
  }

 private:
  void choose_in_section(int first, int last, std::vector<FeaturePoint>& less_flat) {
    std::sort(order_.begin() + first, order_.begin() + last,
              [&](int a, int b) { return smoothness_m2_[a] < smoothness_m2_[b]; });
    choose_edges(first, last);
    choose_flat(first, last);
    for (int i = first; i <= last; ++i) {
      if (is_edge_[i] == 0) less_flat.push_back(scan_.points[i].point);
    }
  }

  void choose_edges(int first, int last) {
    int chosen = 0;
    for (int k = last; k >= first && chosen < kLessSharpPerSection; --k) {
      const int i = order_[k];
      if (passed_over_[i] != 0 || scan_.points[i].ground || smoothness_m2_[i] <= kThreshold_m2) {
        continue;
      }
      ++chosen;
      is_edge_[i] = 1;
      if (chosen <= kSharpPerSection) features_.sharp.push_back(scan_.points[i].point);
      features_.less_sharp.push_back(scan_.points[i].point);
      ranges_.suppress_neighbours(i, passed_over_);
    }
  }

  void choose_flat(int first, int last) {
    int chosen = 0;
    for (int k = first; k <= last; ++k) {
      const int i = order_[k];
      if (passed_over_[i] != 0 || !scan_.points[i].ground || smoothness_m2_[i] >= kThreshold_m2) {
        continue;
      }
      features_.flat.push_back(scan_.points[i].point);
      if (++chosen == kFlatPerSection) return;
      ranges_.suppress_neighbours(i, passed_over_);
    }
  }

  const SegmentedScan& scan_;
  RowRanges ranges_;
  std::vector<float> smoothness_m2_;
  std::vector<std::uint8_t> passed_over_;
  std::vector<std::uint8_t> is_edge_;
  std::vector<int> order_;
  PublishedFeatures features_;
};

}  // namespace

PublishedFeatures published_features(const SegmentedScan& scan) { return Selection(scan).choose(); }

}  // namespace hqslam::slam::as_published

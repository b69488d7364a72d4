#include "published_features.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "front_end/voxel_thinning.h"

namespace hqslam::slam::as_published {

namespace {

constexpr int kSections = 6;
constexpr int kNeighbours = 5;
constexpr int kAdjacentColumns = 10;
constexpr int kSharpPerSection = 2;
constexpr int kLessSharpPerSection = 20;
constexpr int kFlatPerSection = 4;
constexpr float kThreshold_m2 = 0.1F;
constexpr float kDepthJump_m = 0.3F;
constexpr float kParallelShare = 0.02F;
constexpr double kLessFlatLeaf_m = 0.2;

class Selection {
 public:
  explicit Selection(const SegmentedScan& scan)
      : scan_(scan),
        count_(static_cast<int>(scan.points.size())),
        smoothness_m2_(scan.points.size(), 0.0F),
        passed_over_(scan.points.size(), 0),
        is_edge_(scan.points.size(), 0),
        order_(scan.points.size()) {
    for (int i = 0; i < count_; ++i) order_[i] = i;
    find_smoothness();
    mark_occluded();
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
  void find_smoothness() {
    for (int i = kNeighbours; i < count_ - kNeighbours; ++i) {
      float sum_m = -2.0F * kNeighbours * scan_.points[i].range_m;
      for (int j = 1; j <= kNeighbours; ++j) {
        sum_m += scan_.points[i - j].range_m + scan_.points[i + j].range_m;
      }
      smoothness_m2_[i] = sum_m * sum_m;
    }
  }

  void mark_occluded() {
    for (int i = kNeighbours; i < count_ - kNeighbours - 1; ++i) {
      const float range_m = scan_.points[i].range_m;
      const float next_m = scan_.points[i + 1].range_m;
      if (std::abs(scan_.points[i + 1].column - scan_.points[i].column) < kAdjacentColumns) {
        if (range_m - next_m > kDepthJump_m) {
          for (int j = i - kNeighbours; j <= i; ++j) passed_over_[j] = 1;
        } else if (next_m - range_m > kDepthJump_m) {
          for (int j = i + 1; j <= std::min(i + 1 + kNeighbours, count_ - 1); ++j) {
            passed_over_[j] = 1;
          }
        }
      }
      const float before_m = scan_.points[i - 1].range_m;
      if (std::abs(before_m - range_m) > kParallelShare * range_m &&
          std::abs(next_m - range_m) > kParallelShare * range_m) {
        passed_over_[i] = 1;
      }
    }
  }

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
      pass_over_neighbours(i);
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
      pass_over_neighbours(i);
    }
  }

  void pass_over_neighbours(int i) {
    passed_over_[i] = 1;
    for (const int direction : {1, -1}) {
      for (int j = 1; j <= kNeighbours; ++j) {
        const int at = i + direction * j;
        if (at < 0 || at >= count_) break;
        const int gap = scan_.points[at].column - scan_.points[at - direction].column;
        if (std::abs(gap) > kAdjacentColumns) break;
        passed_over_[at] = 1;
      }
    }
  }

  const SegmentedScan& scan_;
  int count_;
  std::vector<float> smoothness_m2_;
  std::vector<std::uint8_t> passed_over_;
  std::vector<std::uint8_t> is_edge_;
  std::vector<int> order_;
  PublishedFeatures features_;
};

}  // namespace

PublishedFeatures published_features(const SegmentedScan& scan) { return Selection(scan).choose(); }

}  // namespace hqslam::slam::as_published

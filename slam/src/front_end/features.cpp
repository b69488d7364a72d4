#include "front_end/features.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <iterator>

#include "front_end/posts.h"
#include "front_end/scattered_returns.h"
#include "front_end/voxel_thinning.h"

namespace hqslam::slam {

namespace {

/// Between neighbours, and between a jump's two sides, as in LeGO-LOAM.
constexpr int kMaxColumnGap = 10;
constexpr int kSlopeRows = 3;  // largest distance of the row above or below, in rows
/// Sine of the angle with the level plane from which on a surface stands: 30 degrees.
constexpr float kMinSteepness = 0.5F;
/// Returns in a row on one surface, from which on it need not stand: floors and ceilings have such
/// runs. With 30 to 40 the real handheld OS0 is less accurate with 16 rows (weights/NOTEBOOK.md).
constexpr int kLongRun = 45;
/// Voxel size to which the points of a row are thinned.
constexpr double kRowLeaf_m = 0.2;
// Of each of the sections into which a row is cut, as in LeGO-LOAM.
constexpr int kSections = 6;
constexpr int kSharpEdges = 2;
constexpr int kEdges = 20;
constexpr int kFlatPoints = 4;
/// Smoothness above which a point can be an edge, below which it can be flat: LeGO-LOAM's 0.1 m^2.
constexpr double kEdgeSmoothness_m = 0.31622776601683794;
/// Smallest smoothness of an edge as a share of its range; LeGO-LOAM: 0.
constexpr double kEdgeSmoothnessPerRange = 0.02;

/// The largest difference in range of neighbouring returns on one surface.
float most_apart_m(float range_m) { return 0.5F + 0.03F * range_m; }

/// The sequence of returns of one row with their properties.
struct Row {
  static constexpr int kHalfWindow = 5;  ///< neighbours on each side, as in LOAM

  std::vector<FeaturePoint> points;
  std::vector<float> range_m;
  std::vector<int> column;
  std::vector<std::uint8_t> ground;
  std::vector<float> smoothness_m;
  /// Near a chosen point, hidden, along the beam, or too near an end of the row.
  std::vector<std::uint8_t> taken;
  std::vector<std::uint8_t> is_edge;
  std::vector<std::uint8_t> is_ring;      ///< of a short run on what does not stand
  std::vector<const FeaturePoint*> post;  ///< the centre of the post that has the point; or nullptr
  std::vector<int> candidates;            ///< of the present section; its memory is reused

  int size() const { return static_cast<int>(range_m.size()); }
  /// Whether neighbours in the sequence are neighbours in the image, too.
  bool are_near(int i, int j) const { return std::abs(column[i] - column[j]) <= kMaxColumnGap; }

  /// |sum of the 10 neighbours' ranges - 10 range| for a point with five on each side.
  float smoothness_at_m(int i) const {
    float sum_m = -2.0F * kHalfWindow * range_m[i];
    for (int k = 1; k <= kHalfWindow; ++k) sum_m += range_m[i - k] + range_m[i + k];
    return std::abs(sum_m);
  }

  /// Whether neighbours in the sequence are on one surface.
  bool are_on_one_surface(int i, int j) const {
    return ground[i] == ground[j] && std::abs(column[i] - column[j]) <= 2 &&
           std::abs(range_m[i] - range_m[j]) < most_apart_m(range_m[j]);
  }

  /// Takes the far side of depth jumps and surfaces along the beam.
  void take_unreliable() {
    // As in LeGO-LOAM.
    constexpr float kDepthJump_m = 0.3F;    // occludes what is behind
    constexpr float kParallelJump = 0.02F;  // share of the range, on both sides: along the beam
    for (int i = kHalfWindow; i + kHalfWindow + 1 < size(); ++i) {
      const float here_m = range_m[i];
      const float next_m = range_m[i + 1];
      if (are_near(i, i + 1)) {
        if (here_m - next_m > kDepthJump_m) {
          std::fill(taken.begin() + i - kHalfWindow, taken.begin() + i + 1, 1);
        } else if (next_m - here_m > kDepthJump_m) {
          std::fill(taken.begin() + i + 1, taken.begin() + i + kHalfWindow + 2, 1);
        }
      }
      const float before_m = range_m[i - 1];
      if (std::abs(before_m - here_m) > kParallelJump * here_m &&
          std::abs(next_m - here_m) > kParallelJump * here_m) {
        taken[i] = 1;
      }
    }
  }

  /// Takes a chosen point and its neighbours, up to the next gap.
  void take_neighbours(int chosen) {
    taken[chosen] = 1;
    for (const int direction : {-1, 1}) {
      for (int k = 1; k <= kHalfWindow; ++k) {
        const int i = chosen + direction * k;
        if (i < 0 || i >= size() || !are_near(i, i - direction)) break;
        taken[i] = 1;
      }
    }
  }
};

/// The ground in the first row with a return above (step -1) or below (1) a pixel.
const Eigen::Vector3f* ground_beside(const OrganizedCloud& cloud, const Segmentation& segmentation,
                                     int row, int column, int step) {
  for (int i = 1; i <= kSlopeRows; ++i) {
    const int other = row + i * step;
    if (other < 0 || other >= cloud.rows) return nullptr;
    const std::size_t pixel = cloud.index(other, column);
    if (segmentation.pixel_class[pixel] == PixelClass::kNoReturn) continue;
    return segmentation.pixel_class[pixel] == PixelClass::kGround ? &cloud.points_m[pixel]
                                                                  : nullptr;
  }
  return nullptr;
}

/// FeaturePoint::slope of a pixel on the ground: the mean of the directions from the point below
/// and to the point above.
Eigen::Vector3f slope_at(const OrganizedCloud& cloud, const Segmentation& segmentation, int row,
                         int column) {
  const Eigen::Vector3f& here_m = cloud.points_m[cloud.index(row, column)];
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (const int step : {-1, 1}) {
    const Eigen::Vector3f* other_m = ground_beside(cloud, segmentation, row, column, step);
    if (other_m != nullptr) sum -= static_cast<float>(step) * (*other_m - here_m).normalized();
  }
  return sum.normalized();  // of zero: zero
}

/// The unit direction, from the lower row to the higher one, between a pixel and that return in the
/// rows above and below which is nearest in range; zero if that is not on the same surface.
Eigen::Vector3f across_rows(const OrganizedCloud& cloud, const std::vector<int>& rows,
                            std::size_t row, int column) {
  const std::size_t here = cloud.index(rows[row], column);
  float least_m = most_apart_m(cloud.range_m[here]);
  Eigen::Vector3f upwards = Eigen::Vector3f::Zero();
  for (const int step : {-1, 1}) {
    const auto other = static_cast<std::ptrdiff_t>(row) + step;
    if (other < 0 || other >= std::ssize(rows)) continue;
    for (const int aside : {-1, 0, 1}) {
      const std::size_t beside =
          cloud.index(rows[other], (column + aside + cloud.columns) % cloud.columns);
      const float apart_m = std::abs(cloud.range_m[beside] - cloud.range_m[here]);
      if (!(cloud.range_m[beside] > 0.0F) || apart_m >= least_m) continue;
      least_m = apart_m;
      upwards = static_cast<float>(step) * (cloud.points_m[here] - cloud.points_m[beside]);
    }
  }
  return upwards.normalized();  // of zero: zero
}

/// Gives the points of objects their slope, and marks the short runs on those that do not stand.
/// Most are undetected ground: its rings travel with the sensor, and would hold it back where
/// little else constrains the motion.
void mark_slopes_and_rings(const OrganizedCloud& cloud, const Eigen::Vector3f& up,
                           const std::vector<int>& rows, std::size_t row_index, Row& row) {
  row.is_ring.assign(row.points.size(), 0);
  for (int first = 0, last = 0; first < row.size(); first = last) {
    for (last = first + 1; last < row.size() && row.are_on_one_surface(last - 1, last);) ++last;
    const bool is_short = last - first < kLongRun;
    for (int i = first; i < last && row.ground[first] == 0; ++i) {
      row.points[i].slope = up;
      const bool is_above_sensor = row.points[i].point_m.dot(up) > 0.0F;
      if (!is_short && !is_above_sensor) continue;
      const Eigen::Vector3f across = across_rows(cloud, rows, row_index, row.column[i]);
      if (across.dot(up) > kMinSteepness) continue;
      if (is_short) row.is_ring[i] = 1;
      row.points[i].slope = across;
    }
  }
}

/// Marks the points on posts: an edge among them is put at the post's centre.
void mark_posts(const std::vector<Post>& posts, Row& row) {
  row.post.assign(row.points.size(), nullptr);
  for (const Post& post : posts) {
    auto i = std::ranges::lower_bound(row.column, post.first_column) - row.column.begin();
    for (; i < row.size() && row.column[i] <= post.last_column; ++i) row.post[i] = &post.centre;
  }
}

Row gather_row(const OrganizedCloud& cloud, const Segmentation& segmentation, int row) {
  Row result;
  const auto most = static_cast<std::size_t>(cloud.columns);
  result.points.reserve(most);
  result.range_m.reserve(most);
  result.column.reserve(most);
  result.ground.reserve(most);
  for (int column = 0; column < cloud.columns; ++column) {
    const std::size_t pixel = cloud.index(row, column);
    const PixelClass pixel_class = segmentation.pixel_class[pixel];
    if (pixel_class == PixelClass::kNoReturn) continue;
    const float offset_s = cloud.time_offset_s.empty() ? 0.0F : cloud.time_offset_s[pixel];
    FeaturePoint point{cloud.points_m[pixel], offset_s, row};
    if (!cloud.intensity.empty()) point.intensity = cloud.intensity[pixel];
    if (pixel_class == PixelClass::kGround) {
      point.slope = slope_at(cloud, segmentation, row, column);
    }
    result.points.push_back(point);
    result.range_m.push_back(cloud.range_m[pixel]);
    result.column.push_back(column);
    result.ground.push_back(pixel_class == PixelClass::kGround ? 1 : 0);
  }
  return result;
}

/// Takes candidates, best first, until there are `wanted`; neighbours of one are left out.
/// better(a, b): whether a goes before b; of equals the first in the row.
template <typename Better, typename Take>
void choose(Row& row, int wanted, const Better& better, const Take& take) {
  std::vector<int>& candidates = row.candidates;
  const auto worse = [&](int a, int b) { return better(b, a) || (!better(a, b) && a > b); };
  std::make_heap(candidates.begin(), candidates.end(), worse);
  for (auto last = candidates.end(); last != candidates.begin() && wanted > 0; --last) {
    std::pop_heap(candidates.begin(), last, worse);
    const int i = *std::prev(last);
    if (row.taken[i] != 0) continue;
    take(i);
    row.take_neighbours(i);
    --wanted;
  }
}

/// Edges of the points first..last-1 of a row: the largest smoothness first.
void choose_edges(Row& row, int first, int last, Features& features) {
  row.candidates.clear();
  for (int i = first; i < last; ++i) {
    const double required_m = std::max(kEdgeSmoothness_m, kEdgeSmoothnessPerRange * row.range_m[i]);
    if (row.taken[i] == 0 && row.ground[i] == 0 && row.is_ring[i] == 0 &&
        row.smoothness_m[i] > required_m) {
      row.candidates.push_back(i);
    }
  }
  int sharp = kSharpEdges;
  choose(
      row, kEdges, [&](int a, int b) { return row.smoothness_m[a] > row.smoothness_m[b]; },
      [&](int i) {
        const FeaturePoint& edge = row.post[i] != nullptr ? *row.post[i] : row.points[i];
        if (sharp-- > 0) features.sharp_edges.push_back(edge);
        features.edges.push_back(edge);
        row.is_edge[i] = 1;
      });
}

/// Flat ground points of the points first..last-1 of a row: the smallest smoothness first.
void choose_flat_points(Row& row, int first, int last, Features& features) {
  row.candidates.clear();
  for (int i = first; i < last; ++i) {
    if (row.taken[i] == 0 && row.ground[i] != 0 && row.smoothness_m[i] < kEdgeSmoothness_m) {
      row.candidates.push_back(i);
    }
  }
  choose(
      row, kFlatPoints, [&](int a, int b) { return row.smoothness_m[a] < row.smoothness_m[b]; },
      [&](int i) { features.flat_points.push_back(row.points[i]); });
}

Features features_of_row(const OrganizedCloud& cloud, const Segmentation& segmentation,
                         const std::vector<int>& rows, std::size_t row_index, bool returns_fail) {
  Row row = gather_row(cloud, segmentation, rows[row_index]);
  row.smoothness_m.assign(row.points.size(), 0.0F);
  row.taken.assign(row.points.size(), 1);
  for (int i = Row::kHalfWindow; i + Row::kHalfWindow < row.size(); ++i) {
    row.smoothness_m[i] = row.smoothness_at_m(i);
    row.taken[i] = 0;
  }
  row.take_unreliable();
  mark_slopes_and_rings(cloud, segmentation.up.cast<float>(), rows, row_index, row);
  const std::vector<Post> posts = posts_in_row(cloud, segmentation, rows[row_index], returns_fail);
  mark_posts(posts, row);
  row.is_edge.assign(row.points.size(), 0);

  Features features;
  for (const Post& post : posts) features.posts.push_back(post.centre);
  for (int section = 0; section < kSections; ++section) {
    const int first = row.size() * section / kSections;
    const int last = row.size() * (section + 1) / kSections;
    choose_edges(row, first, last, features);
    choose_flat_points(row, first, last, features);
  }
  std::vector<FeaturePoint> ground;
  std::vector<FeaturePoint> surfaces;
  ground.reserve(row.points.size());
  surfaces.reserve(row.points.size());
  for (int i = 0; i < row.size(); ++i) {
    if (row.is_edge[i] != 0 || row.is_ring[i] != 0) continue;
    (row.ground[i] != 0 ? ground : surfaces).push_back(row.points[i]);
  }
  features.ground = thin(ground, kRowLeaf_m);
  features.surfaces = thin(surfaces, kRowLeaf_m);
  return features;
}

}  // namespace

Features extract_features(const OrganizedCloud& cloud, const Segmentation& segmentation,
                          const std::optional<RowSelection>& measured_rows) {
  const std::vector<int> rows = selected_rows(cloud.rows, measured_rows.value_or(RowSelection{}));
  std::vector<Features> of_row(rows.size());
  const bool returns_fail = has_failing_returns(cloud);
#pragma omp parallel for schedule(dynamic)
  for (std::size_t i = 0; i < rows.size(); ++i) {
    of_row[i] = features_of_row(cloud, segmentation, rows, i, returns_fail);
  }
  Features all;
  all.up = segmentation.up;
  for (const auto kind : {&Features::sharp_edges, &Features::edges, &Features::flat_points,
                          &Features::ground, &Features::surfaces, &Features::posts}) {
    std::size_t points = 0;
    for (const Features& row : of_row) points += (row.*kind).size();
    (all.*kind).reserve(points);
    for (int i = 0; i < static_cast<int>(of_row.size()); ++i) {
      for (FeaturePoint& point : of_row[i].*kind) {
        point.row = i;
        (all.*kind).push_back(point);
      }
    }
  }
  return all;
}

}  // namespace hqslam::slam

#include "published_odometry.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "hqslam/core/angles.h"

namespace hqslam::slam::as_published {

namespace {

constexpr int kIterations = 25;
constexpr int kSearchEvery = 5;
constexpr double kGain = 0.05;
constexpr double kMinEigenvalue = 10.0;
constexpr float kMaxSquaredDistance_m2 = 25.0F;
constexpr double kRowReach = 2.5;
constexpr int kMinCorrespondences = 10;
constexpr std::size_t kMinLastEdges = 10;
constexpr std::size_t kMinLastSurfaces = 100;
constexpr double kConverged_deg = 0.1;
constexpr double kConverged_m = 0.001;
constexpr double kWeightFall = 1.8;
constexpr int kNone = -1;

/// The nearest point, kNone if it is not within reach.
int nearest(const RowPoints& target, const Eigen::Vector3f& query_m) {
  int best = kNone;
  float best_m2 = kMaxSquaredDistance_m2;
  for (std::size_t i = 0; i < target.points_m.size(); ++i) {
    const float m2 = (target.points_m[i] - query_m).squaredNorm();
    if (m2 < best_m2) {
      best_m2 = m2;
      best = static_cast<int>(i);
    }
  }
  return best;
}

/// The nearest point, of those in the row of `closest` or in others, after and before it: upwards
/// to index `bound`, downwards to 0, in both directions while the rows are within reach.
int second_nearest(const RowPoints& target, const Eigen::Vector3f& query_m, int closest, int bound,
                   bool in_same_row) {
  const auto& [points_m, rows] = target;
  int best = kNone;
  float best_m2 = kMaxSquaredDistance_m2;
  const auto look_at = [&](int i) {
    if ((target.rows[i] == target.rows[closest]) != in_same_row) return;
    const float m2 = (target.points_m[i] - query_m).squaredNorm();
    if (m2 < best_m2) {
      best_m2 = m2;
      best = i;
    }
  };
  // The program's defect: `bound` is the number of the scan's features, not of these points.
  const int end = std::min(bound, static_cast<int>(points_m.size()));
  for (int i = closest + 1; i < end && rows[i] <= rows[closest] + kRowReach; ++i) look_at(i);
  for (int i = closest - 1; i >= 0 && rows[i] >= rows[closest] - kRowReach; --i) look_at(i);
  return best;
}

/// What a feature was matched with.
struct PublishedMatch {
  int first = kNone;
  int in_other_row = kNone;
  int in_same_row = kNone;  ///< of a plane
};

/// bound: of second_nearest.
PublishedMatch match_of(const RowPoints& target, const Eigen::Vector3f& query_m, int bound,
                        bool is_plane) {
  PublishedMatch match;
  match.first = nearest(target, query_m);
  if (match.first == kNone) return match;
  match.in_other_row = second_nearest(target, query_m, match.first, bound, false);
  if (is_plane) match.in_same_row = second_nearest(target, query_m, match.first, bound, true);
  return match;
}

/// From the line or plane through the points; nothing where one is missing.
std::optional<WeightedDistance> distance_from(const RowPoints& target, const PublishedMatch& match,
                                              bool is_plane, const Eigen::Vector3d& p) {
  if (match.in_other_row == kNone || (is_plane && match.in_same_row == kNone)) return std::nullopt;
  const Eigen::Vector3d a = target.points_m[match.first].cast<double>();
  const Eigen::Vector3d c = target.points_m[match.in_other_row].cast<double>();
  if (!is_plane) return distance_from_line(p, a, c);
  const Eigen::Vector3d b = target.points_m[match.in_same_row].cast<double>();
  const Eigen::Vector3d normal = (b - a).cross(c - a).normalized();
  return WeightedDistance{normal, normal.dot(p - a)};
}

}  // namespace

Eigen::Vector3d PublishedOdometry::at_start(const FeaturePoint& point) const {
  const double s = point.time_offset_s / scan_period_s_ + 0.5;
  return pose_of(s * motion_) * point.point_m.cast<double>();
}

/// Edges are matched with lines, for yaw, x and y, flat points with planes, for roll, pitch and z.
void PublishedOdometry::match(const std::vector<FeaturePoint>& features, const RowPoints& target,
                              bool with_planes) {
  const auto bound = static_cast<int>(features.size());
  const int angles = with_planes ? 2 : 1;
  const std::array<int, 3> parameters =
      with_planes ? std::array{0, 1, 5} : std::array{2, 3, 4};  // of motion_
  std::vector<PublishedMatch> matches(features.size());
  PublishedSteps<3> steps(kGain, kMinEigenvalue);
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const std::array<Eigen::Matrix3d, 3> dR = rotation_derivatives(motion_);
    int used = 0;
    for (std::size_t i = 0; i < features.size(); ++i) {
      const Eigen::Vector3d p = at_start(features[i]);
      if (iteration % kSearchEvery == 0) {
        matches[i] = match_of(target, p.cast<float>(), bound, with_planes);
      }
      const auto found = distance_from(target, matches[i], with_planes, p);
      if (!found) continue;
      const double fall = kWeightFall * std::abs(found->distance_m);
      const double weight = iteration < kSearchEvery ? 1.0
                            : with_planes            ? 1.0 - fall / std::sqrt(p.norm())
                                                     : 1.0 - fall;
      if (!(weight > kMinWeight) || found->distance_m == 0.0) continue;
      const Eigen::Vector3d raw = features[i].point_m.cast<double>();
      Eigen::Vector3d row;
      for (int k = 0; k < 3; ++k) {  // the Jacobian is that of the end of the sweep for every point
        row[k] = k < angles ? found->gradient.dot(dR[parameters[k]] * raw)
                            : found->gradient[parameters[k] - 3];
      }
      steps.add(weight * row, weight * found->distance_m);
      ++used;
    }
    if (used < kMinCorrespondences) {
      steps.discard();
      continue;
    }
    const Eigen::Vector3d step = steps.take();
    for (int k = 0; k < 3; ++k) motion_(parameters[k]) += step(k);
    if (degrees(step.head(angles).norm()) < kConverged_deg &&
        step.tail(3 - angles).norm() < kConverged_m) {
      break;
    }
  }
}

LastScan PublishedOdometry::at_end(const PublishedFeatures& features) const {
  const Pose T_end_start = pose_of(motion_).inverse();
  const auto moved = [&](const std::vector<FeaturePoint>& points) {
    RowPoints result;
    for (const FeaturePoint& point : points) {
      result.points_m.emplace_back((T_end_start * at_start(point)).cast<float>());
      result.rows.push_back(point.row);
    }
    return result;
  };
  return {moved(features.less_sharp), moved(features.less_flat)};
}

void PublishedOdometry::add(const PublishedFeatures& features) {
  if (last_) {
    if (last_->edges.rows.size() >= kMinLastEdges &&
        last_->surfaces.rows.size() >= kMinLastSurfaces) {
      match(features.flat, last_->surfaces, true);
      match(features.sharp, last_->edges, false);
    }
    T_odom_end_ = orthonormalized(T_odom_end_ * pose_of(motion_));
    has_motion_ = true;
  }
  last_ = at_end(features);
}

}  // namespace hqslam::slam::as_published

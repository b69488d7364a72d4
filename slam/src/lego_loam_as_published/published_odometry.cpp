#include "published_odometry.h"

#include <algorithm>
#include <cmath>

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
int nearest(const std::vector<Eigen::Vector3f>& points_m, const Eigen::Vector3f& query_m) {
  int best = kNone;
  float best_m2 = kMaxSquaredDistance_m2;
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    const float m2 = (points_m[i] - query_m).squaredNorm();
    if (m2 < best_m2) {
      best_m2 = m2;
      best = static_cast<int>(i);
    }
  }
  return best;
}

/// The nearest point, of those that `wanted` says by their row, after and before `closest`: upwards
/// to index `bound`, downwards to 0, in both directions while the rows are within reach.
template <typename Wanted>
int second_nearest(const std::vector<Eigen::Vector3f>& points_m, const std::vector<int>& rows,
                   const Eigen::Vector3f& query_m, int closest, int bound, const Wanted& wanted) {
  int best = kNone;
  float best_m2 = kMaxSquaredDistance_m2;
  const auto look_at = [&](int i) {
    if (!wanted(rows[i])) return;
    const float m2 = (points_m[i] - query_m).squaredNorm();
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

struct LineMatch {
  int first = kNone;
  int second = kNone;
};

struct PlaneMatch {
  int first = kNone;
  int second = kNone;  ///< same row
  int third = kNone;   ///< another row
};

}  // namespace

Eigen::Vector3d PublishedOdometry::at_start(const FeaturePoint& point) const {
  const double s = point.time_offset_s / scan_period_s_ + 0.5;
  return pose_of(s * motion_) * point.point_m.cast<double>();
}

void PublishedOdometry::match_surfaces(const std::vector<FeaturePoint>& flat) {
  std::vector<PlaneMatch> matches(flat.size());
  PublishedSteps<3> steps(kGain, kMinEigenvalue);
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const std::array<Eigen::Matrix3d, 3> dR = rotation_derivatives(motion_);
    int used = 0;
    for (std::size_t i = 0; i < flat.size(); ++i) {
      const Eigen::Vector3d p = at_start(flat[i]);
      PlaneMatch& match = matches[i];
      if (iteration % kSearchEvery == 0) {
        const Eigen::Vector3f query_m = p.cast<float>();
        const auto search = [&](const auto& wanted) {
          return second_nearest(last_.surfaces_m, last_.surface_rows, query_m, match.first,
                                static_cast<int>(flat.size()), wanted);
        };
        match = {nearest(last_.surfaces_m, query_m), kNone, kNone};
        if (match.first != kNone) {
          const int row = last_.surface_rows[match.first];
          match.second = search([&](int other) { return other == row; });
          match.third = search([&](int other) { return other != row; });
        }
      }
      if (match.second == kNone || match.third == kNone) continue;
      const Eigen::Vector3d a = last_.surfaces_m[match.first].cast<double>();
      const Eigen::Vector3d b = last_.surfaces_m[match.second].cast<double>();
      const Eigen::Vector3d c = last_.surfaces_m[match.third].cast<double>();
      const Eigen::Vector3d normal = (b - a).cross(c - a).normalized();
      const double distance_m = normal.dot(p - a);
      const double weight = iteration < kSearchEvery
                                ? 1.0
                                : 1.0 - kWeightFall * std::abs(distance_m) / std::sqrt(p.norm());
      if (!(weight > kMinWeight) || distance_m == 0.0) continue;
      const Eigen::Vector3d raw = flat[i].point_m.cast<double>();
      // The Jacobian is that of the end of the sweep for every point.
      steps.add(
          weight * Eigen::Vector3d(normal.dot(dR[0] * raw), normal.dot(dR[1] * raw), normal.z()),
          weight * distance_m);
      ++used;
    }
    if (used < kMinCorrespondences) {
      steps.discard();
      continue;
    }
    const Eigen::Vector3d step = steps.take();
    motion_(0) += step(0);
    motion_(1) += step(1);
    motion_(5) += step(2);
    if (degrees(step.head<2>().norm()) < kConverged_deg && std::abs(step(2)) < kConverged_m) break;
  }
}

void PublishedOdometry::match_edges(const std::vector<FeaturePoint>& sharp) {
  std::vector<LineMatch> matches(sharp.size());
  PublishedSteps<3> steps(kGain, kMinEigenvalue);
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const std::array<Eigen::Matrix3d, 3> dR = rotation_derivatives(motion_);
    int used = 0;
    for (std::size_t i = 0; i < sharp.size(); ++i) {
      const Eigen::Vector3d p = at_start(sharp[i]);
      LineMatch& match = matches[i];
      if (iteration % kSearchEvery == 0) {
        const Eigen::Vector3f query_m = p.cast<float>();
        match = {nearest(last_.edges_m, query_m), kNone};
        if (match.first != kNone) {
          const int row = last_.edge_rows[match.first];
          match.second = second_nearest(last_.edges_m, last_.edge_rows, query_m, match.first,
                                        static_cast<int>(sharp.size()),
                                        [&](int other) { return other != row; });
        }
      }
      if (match.second == kNone) continue;
      const WeightedDistance line = distance_from_line(p, last_.edges_m[match.first].cast<double>(),
                                                       last_.edges_m[match.second].cast<double>());
      const double weight = iteration < kSearchEvery ? 1.0 : 1.0 - kWeightFall * line.distance_m;
      if (!(weight > kMinWeight) || line.distance_m == 0.0) continue;
      const Eigen::Vector3d raw = sharp[i].point_m.cast<double>();
      steps.add(weight * Eigen::Vector3d(line.gradient.dot(dR[2] * raw), line.gradient.x(),
                                         line.gradient.y()),
                weight * line.distance_m);
      ++used;
    }
    if (used < kMinCorrespondences) {
      steps.discard();
      continue;
    }
    const Eigen::Vector3d step = steps.take();
    motion_(2) += step(0);
    motion_(3) += step(1);
    motion_(4) += step(2);
    if (degrees(std::abs(step(0))) < kConverged_deg && step.tail<2>().norm() < kConverged_m) break;
  }
}

LastScan PublishedOdometry::at_end(const PublishedFeatures& features) const {
  const Pose T_end_start = pose_of(motion_).inverse();
  LastScan last;
  for (const FeaturePoint& point : features.less_sharp) {
    last.edges_m.emplace_back((T_end_start * at_start(point)).cast<float>());
    last.edge_rows.push_back(point.row);
  }
  for (const FeaturePoint& point : features.less_flat) {
    last.surfaces_m.emplace_back((T_end_start * at_start(point)).cast<float>());
    last.surface_rows.push_back(point.row);
  }
  return last;
}

void PublishedOdometry::add(const PublishedFeatures& features) {
  if (has_last_) {
    if (last_.edges_m.size() >= kMinLastEdges && last_.surfaces_m.size() >= kMinLastSurfaces) {
      match_surfaces(features.flat);
      match_edges(features.sharp);
    }
    T_odom_end_ = orthonormalized(T_odom_end_ * pose_of(motion_));
    has_motion_ = true;
  }
  last_ = at_end(features);
  has_last_ = true;
}

}  // namespace hqslam::slam::as_published

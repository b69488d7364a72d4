#include "odometry.h"

namespace hqslam::lego_loam {

namespace {

constexpr float kReach_m = 5.0F;
constexpr int kRowsBeside = 2;
constexpr std::size_t kMinLastEdges = 10;
constexpr std::size_t kMinLastPlanes = 100;
constexpr double kWeightFall = 1.8;  // per metre
constexpr int kMinFeatures = 10;
constexpr Schedule kPlanes = {5, 5, kMinFeatures, 0.001, 0.1};
constexpr Schedule kLines = {5, 5, kPerLine* kMinFeatures, 0.001, 0.1};

/// The last scan's point nearest to a feature, the second nearest in its row, and the nearest one
/// in the two rows above and the two below; each where there is one within reach.
struct Neighbours {
  std::optional<Point> nearest;
  std::optional<Point> same_row;
  std::optional<Point> other_row;
};

Neighbours neighbours_of(const Point& p, const SearchCloud& last) {
  const std::vector<int> index = last.nearest(p, 1, kReach_m);
  if (index.empty()) return {};
  const Point& nearest = (*last.cloud)[index[0]];
  const int row = row_of(nearest);
  Neighbours found{nearest, std::nullopt, std::nullopt};
  float same_m2 = kReach_m * kReach_m;
  float other_m2 = kReach_m * kReach_m;
  auto q = std::partition_point(last.cloud->begin(), last.cloud->end(), [&](const Point& point) {
    return row_of(point) < row - kRowsBeside;
  });
  for (; q != last.cloud->end() && row_of(*q) <= row + kRowsBeside; ++q) {
    const float m2 = (q->getVector3fMap() - p.getVector3fMap()).squaredNorm();
    const bool in_row = row_of(*q) == row;
    if (&*q == &nearest || m2 >= (in_row ? same_m2 : other_m2)) continue;
    (in_row ? found.same_row : found.other_row) = *q;
    (in_row ? same_m2 : other_m2) = m2;
  }
  return found;
}

/// The feature and the last scan's point that it is matched with.
Constraint pair_of(const Point& feature, const Point& last) {
  return {position_m(feature), position_m(last), Eigen::Vector3d::Zero(),
          1.0 + sweep_fraction(feature) - sweep_fraction(last)};
}

Constraints planes_of(const Cloud& flat, const SearchCloud& ground, const PoseParameters& motion,
                      double fall) {
  Constraints constraints;
  for (const Point& feature : flat) {
    const auto [nearest, same, other] = neighbours_of(moved(pose_of(motion), feature), ground);
    if (!nearest || !same || !other) continue;
    Constraint plane = pair_of(feature, *nearest);
    plane.n = (position_m(*same) - plane.q).cross(position_m(*other) - plane.q).normalized();
    add_plane(plane, pose_of(motion, plane.s), fall, constraints);
  }
  return constraints;
}

Constraints lines_of(const Cloud& sharp, const SearchCloud& edges, const PoseParameters& motion,
                     double fall) {
  Constraints constraints;
  for (const Point& feature : sharp) {
    const auto [nearest, same, other] = neighbours_of(moved(pose_of(motion), feature), edges);
    if (!nearest || !other) continue;
    const Constraint line = pair_of(feature, *nearest);
    const Eigen::Vector3d u = (position_m(*other) - line.q).normalized();
    add_line(line, u, pose_of(motion, line.s), fall, constraints);
  }
  return constraints;
}

double fall_in(int search) { return search > 0 ? kWeightFall : 0.0; }

}  // namespace

const OdometryResult& Odometry::add(const Features& features) {
  result_.planes = result_.edges = 0;
  result_.has_motion = last_edges_.has_value();
  if (result_.has_motion && last_edges_->cloud->size() >= kMinLastEdges &&
      last_ground_->cloud->size() >= kMinLastPlanes) {
    PoseParameters& motion = result_.motion;
    result_.planes = align(motion, Free::kOutOfPlane, kPlanes, [&](const auto& now, int search) {
      return planes_of(features.flat, *last_ground_, now, fall_in(search));
    });
    result_.edges = align(motion, Free::kInPlane, kLines, [&](const auto& now, int search) {
      return lines_of(features.sharp, *last_edges_, now, fall_in(search));
    });
    result_.edges /= kPerLine;
  }
  result_.T_odom_end = orthonormalized(result_.T_odom_end * pose_of(result_.motion));
  last_edges_.emplace(features.less_sharp);
  last_ground_.emplace(features.less_flat_ground);
  return result_;
}

Cloud at_sweep_end(const Cloud& cloud, const PoseParameters& motion) {
  const Pose T_end_start = pose_of(motion).inverse();
  Cloud result;
  for (const Point& point : cloud) {
    result.push_back(moved(T_end_start * pose_of(motion, sweep_fraction(point)), point));
  }
  return result;
}

}  // namespace hqslam::lego_loam

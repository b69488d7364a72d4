#include "hqslam/evaluation/trajectory_error.h"

#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "hqslam/core/angles.h"
#include "hqslam/core/error.h"

namespace hqslam {

namespace {

/// Of singular values of a covariance of positions: below it they are on one line.
constexpr double kDegenerate = 1e-9;

/// In the order of Alignment.
constexpr std::array<std::string_view, 3> kAlignments = {"none", "first", "se3"};

// The rotation R and translation t that move the estimate's positions e_i onto the reference's r_i.
//
// In:  pairs of positions, metres. Out: T_reference_estimate.
// Minimises sum |r_i - (R e_i + t)|^2: with the centred positions' covariance
// C = sum (r_i - r) (e_i - e)^T = U S V^T:  R = U diag(1, 1, det(U V^T)) V^T,  t = r - R e.
// Source: Umeyama, "Least-squares estimation of transformation parameters between two point
// patterns", PAMI 1991, without the scale.
//
// Positions on one line, or all in one place, leave a rotation open. Then the orientations decide:
// sum R_r_i R_e_i^T joins C with a weight that does not disturb what the positions determine.
Pose umeyama(const Trajectory& estimate, const Trajectory& reference, const PosePairs& pairs) {
  const double n = static_cast<double>(pairs.estimate.size());
  Eigen::Vector3d mean_e = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean_r = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < pairs.estimate.size(); ++i) {
    mean_e += estimate[pairs.estimate[i]].T_map_sensor.translation() / n;
    mean_r += reference[pairs.reference[i]].T_map_sensor.translation() / n;
  }
  Eigen::Matrix3d C = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d orientations = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < pairs.estimate.size(); ++i) {
    const Pose& T_e = estimate[pairs.estimate[i]].T_map_sensor;
    const Pose& T_r = reference[pairs.reference[i]].T_map_sensor;
    C += (T_r.translation() - mean_r) * (T_e.translation() - mean_e).transpose() / n;
    orientations += T_r.linear() * T_e.linear().transpose() / n;
  }
  const Eigen::Vector3d singular = Eigen::JacobiSVD<Eigen::Matrix3d>(C).singularValues();
  if (singular(1) <= kDegenerate * std::max(singular(0), 1.0)) {
    C += 1e-6 * std::max(singular(0), 1e-6) * orientations;
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(C, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d signs = Eigen::Vector3d::Ones();
  signs(2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  Pose T_reference_estimate = Pose::Identity();
  T_reference_estimate.linear() = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  T_reference_estimate.translation() = mean_r - T_reference_estimate.linear() * mean_e;
  return T_reference_estimate;
}

// Whether an alignment by positions determines the turn about a path that is nearly a line.
//
// In:  n aligned positions, metres; their errors' RMS sigma. Out: sigma / (s sqrt(n)) <= 1 degree.
// s^2 is the second eigenvalue of the positions' covariance: their distance from the line. Errors
// of sigma at that distance turn a least-squares alignment by that much. Positions exactly on a
// line are aligned by their orientations.
bool is_turn_known(const AbsolutePoseError& error) {
  const double n = static_cast<double>(error.pairs.estimate.size());
  Eigen::Matrix3Xd places(3, error.pairs.estimate.size());
  for (Eigen::Index i = 0; i < places.cols(); ++i) {
    const std::size_t pose = error.pairs.estimate[static_cast<std::size_t>(i)];
    places.col(i) = error.aligned_estimate[pose].T_map_sensor.translation();
  }
  places.colwise() -= Eigen::Vector3d(places.rowwise().mean());
  const Eigen::Vector3d spread = Eigen::JacobiSVD<Eigen::Matrix3Xd>(places).singularValues();
  if (spread(1) * spread(1) <= n * kDegenerate * std::max(spread(0) * spread(0) / n, 1.0)) {
    return true;
  }
  return error.translation_statistics.rmse <= kDegree_rad * spread(1);  // s sqrt(n)
}

Pose alignment_of(const Trajectory& estimate, const Trajectory& reference, const PosePairs& pairs,
                  Alignment alignment) {
  if (alignment == Alignment::kNone) return Pose::Identity();
  if (alignment == Alignment::kSe3) return umeyama(estimate, reference, pairs);
  return reference[pairs.reference[0]].T_map_sensor *
         estimate[pairs.estimate[0]].T_map_sensor.inverse();
}

/// Per pose of the estimate the index of the reference's at its time.
std::vector<std::optional<std::size_t>> partners(const PosePairs& pairs, std::size_t poses) {
  std::vector<std::optional<std::size_t>> result(poses);
  for (std::size_t i = 0; i < pairs.estimate.size(); ++i) {
    result[pairs.estimate[i]] = pairs.reference[i];
  }
  return result;
}

bool touches(const Slip& slip, std::size_t first, std::size_t last) {
  return slip.first <= last && first <= slip.last;
}

/// E = (T_ref_from^-1 T_ref_to)^-1 (T_est_from^-1 T_est_to): what an estimate adds to the true
/// motion between two poses. The frames of the two trajectories need not agree.
Pose motion_error(const StampedPose& from, const StampedPose& to, const StampedPose& true_from,
                  const StampedPose& true_to) {
  const Pose true_motion = true_from.T_map_sensor.inverse() * true_to.T_map_sensor;
  return true_motion.inverse() * (from.T_map_sensor.inverse() * to.T_map_sensor);
}

/// Throws Error if there are fewer than `expected`.
void require_pairs(const PosePairs& pairs, std::size_t expected, double max_difference_s) {
  if (pairs.estimate.size() >= expected) return;
  throw Error(
      "expected at least {} poses of estimate and reference with stamps at most {} s apart, found "
      "{}; give trajectories of the same recording with stamps in seconds",
      expected, max_difference_s, pairs.estimate.size());
}

}  // namespace

std::string_view name(Alignment alignment) {
  return kAlignments[static_cast<std::size_t>(alignment)];
}

Alignment alignment_from_name(std::string_view name) {
  const auto found = std::ranges::find(kAlignments, name);
  if (found != kAlignments.end()) return static_cast<Alignment>(found - kAlignments.begin());
  throw Error("alignment: expected none, first or se3, found '{}'", name);
}

Statistics statistics_of(std::vector<double> values) {
  Statistics statistics;
  if (values.empty()) return statistics;
  const double n = static_cast<double>(values.size());
  for (const double value : values) {
    statistics.mean += value / n;
    statistics.rmse += value * value / n;
  }
  statistics.rmse = std::sqrt(statistics.rmse);
  std::ranges::sort(values);
  const std::size_t middle = values.size() / 2;
  statistics.median =
      values.size() % 2 == 1 ? values[middle] : (values[middle - 1] + values[middle]) / 2.0;
  statistics.p95 = values[static_cast<std::size_t>(std::ceil(0.95 * n)) - 1];
  statistics.max = values.back();
  return statistics;
}

PosePairs associate(const Trajectory& estimate, const Trajectory& reference,
                    double max_difference_s) {
  PosePairs pairs;
  if (reference.empty()) return pairs;
  const auto difference_s = [&](std::size_t e, std::size_t r) {
    return std::abs(estimate[e].stamp_s - reference[r].stamp_s);
  };
  std::size_t r = 0;
  for (std::size_t e = 0; e < estimate.size(); ++e) {
    while (r + 1 < reference.size() && difference_s(e, r + 1) <= difference_s(e, r)) ++r;
    if (!(difference_s(e, r) <= max_difference_s)) continue;
    if (!pairs.reference.empty() && pairs.reference.back() == r) {
      // Two estimates near one reference pose: the nearer one keeps it.
      if (difference_s(e, r) < difference_s(pairs.estimate.back(), r)) pairs.estimate.back() = e;
      continue;
    }
    pairs.estimate.push_back(e);
    pairs.reference.push_back(r);
  }
  return pairs;
}

AbsolutePoseError absolute_pose_error(const Trajectory& estimate, const Trajectory& reference,
                                      Alignment alignment, double max_difference_s) {
  AbsolutePoseError error;
  error.alignment = alignment;
  error.pairs = associate(estimate, reference, max_difference_s);
  require_pairs(error.pairs, alignment == Alignment::kSe3 ? 3 : 2, max_difference_s);
  const Pose T_reference_estimate = alignment_of(estimate, reference, error.pairs, alignment);
  error.aligned_estimate = estimate;
  for (StampedPose& pose : error.aligned_estimate) {
    pose.T_map_sensor = T_reference_estimate * pose.T_map_sensor;
  }
  for (std::size_t i = 0; i < error.pairs.estimate.size(); ++i) {
    const Pose difference = reference[error.pairs.reference[i]].T_map_sensor.inverse() *
                            error.aligned_estimate[error.pairs.estimate[i]].T_map_sensor;
    error.translation_m.push_back(difference.translation().norm());
    error.rotation_rad.push_back(rotation_angle_rad(difference));
  }
  error.translation_statistics = statistics_of(error.translation_m);
  error.rotation_statistics = statistics_of(error.rotation_rad);
  error.is_rotation_known = alignment != Alignment::kSe3 || is_turn_known(error);
  return error;
}

// E = (T_ref_i^-1 T_ref_j)^-1 (T_est_i^-1 T_est_j) for each pair i and the first pair j to which
// the reference's path is at least as long as the stretch. Source: Sturm et al., "A benchmark for
// the evaluation of RGB-D SLAM systems", IROS 2012; stretches by length as in KITTI's odometry
// benchmark.
RelativePoseError relative_pose_error(const Trajectory& estimate, const Trajectory& reference,
                                      double stretch_m, double max_difference_s) {
  if (!(stretch_m > 0.0) || !std::isfinite(stretch_m)) {
    throw Error("stretch_m: expected a positive length, found {}", stretch_m);
  }
  const PosePairs pairs = associate(estimate, reference, max_difference_s);
  require_pairs(pairs, 2, max_difference_s);
  std::vector<double> path_m = {0.0};
  for (std::size_t i = 1; i < reference.size(); ++i) {
    path_m.push_back(path_m.back() + (reference[i].T_map_sensor.translation() -
                                      reference[i - 1].T_map_sensor.translation())
                                         .norm());
  }
  RelativePoseError error;
  error.stretch_m = stretch_m;
  // A path that is a whole number of steps long must not miss its last step by rounding.
  const double shortest_m = stretch_m * (1.0 - 1e-9);
  std::size_t j = 0;
  for (std::size_t i = 0; i < pairs.estimate.size(); ++i) {
    const auto travelled_m = [&](std::size_t to) {
      return path_m[pairs.reference[to]] - path_m[pairs.reference[i]];
    };
    while (j < pairs.estimate.size() && travelled_m(j) < shortest_m) ++j;
    if (j == pairs.estimate.size()) break;
    const Pose difference =
        motion_error(estimate[pairs.estimate[i]], estimate[pairs.estimate[j]],
                     reference[pairs.reference[i]], reference[pairs.reference[j]]);
    error.first.push_back(pairs.reference[i]);
    error.last.push_back(pairs.reference[j]);
    error.translation_m.push_back(difference.translation().norm());
    error.rotation_rad.push_back(rotation_angle_rad(difference));
  }
  error.translation_statistics = statistics_of(error.translation_m);
  error.rotation_statistics = statistics_of(error.rotation_rad);
  return error;
}

std::vector<Slip> slips(const Trajectory& estimate, const Trajectory& reference,
                        double max_difference_s) {
  const PosePairs pairs = associate(estimate, reference, max_difference_s);
  require_pairs(pairs, 2, max_difference_s);
  const auto partner = partners(pairs, estimate.size());
  std::vector<Slip> result;
  for (std::size_t i = 0; i + kSlipScans < estimate.size(); ++i) {
    if (!partner[i] || !partner[i + kSlipScans]) continue;
    const std::size_t first = *partner[i];
    const std::size_t last = *partner[i + kSlipScans];
    const Pose difference =
        motion_error(estimate[i], estimate[i + kSlipScans], reference[first], reference[last]);
    const double translation_m = difference.translation().norm();
    const double rotation_rad = rotation_angle_rad(difference);
    // Written so that a pose that is not a number is a slip.
    if (translation_m <= kSlip_m && rotation_rad <= kSlip_rad) continue;
    if (result.empty() || first > result.back().last + 1) result.push_back({first, last});
    Slip& slip = result.back();
    slip.last = last;
    slip.translation_m = std::max(slip.translation_m, translation_m);
    slip.rotation_rad = std::max(slip.rotation_rad, rotation_rad);
  }
  return result;
}

double slips_per_100_km(std::size_t slips, double path_m) {
  constexpr double kMetres = 100e3;
  return path_m > 0.0 ? kMetres * static_cast<double>(slips) / path_m : 0.0;
}

Drift drift(const RelativePoseError& error, const std::vector<Slip>& left_out) {
  Drift result;
  for (std::size_t i = 0; i < error.translation_m.size(); ++i) {
    const bool slipped = std::ranges::any_of(
        left_out, [&](const Slip& slip) { return touches(slip, error.first[i], error.last[i]); });
    if (slipped) continue;
    ++result.pieces;
    result.translation_percent += 100.0 * error.translation_m[i] / error.stretch_m;
    result.rotation_deg_per_100m +=
        100.0 * error.rotation_rad[i] * 180.0 / std::numbers::pi / error.stretch_m;
  }
  if (result.pieces > 0) {
    result.translation_percent /= static_cast<double>(result.pieces);
    result.rotation_deg_per_100m /= static_cast<double>(result.pieces);
  }
  return result;
}

}  // namespace hqslam

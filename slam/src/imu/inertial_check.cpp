#include "imu/inertial_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>
#include <vector>

#include "hqslam/core/angles.h"
#include "hqslam/core/imu_sample.h"

namespace hqslam::slam {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// With right data the mean over about 20 scans stays below 0.75 (simulated drives of all kinds; a
/// registration's errors are assumed larger than they usually are); with a sensor that is stuck,
/// late or mounted otherwise it exceeds 1 within 2 to 5 seconds. The three scans that one wrong
/// sample affects do not reach it, since a scan counts as 5 at most.
constexpr double kMostMeanInnovation = 1.0;
constexpr double kShareOfScan = 0.05;
/// Turns are compared over this many scans, during which the sensor turned by this much. With right
/// data at most 0.003 rad/s remain unexplained on streets and 0.009 indoors, with 16 rows
/// (simulated drives of all kinds).
constexpr std::size_t kCompared = 40;
/// A sensor can be proven by this many: a hand turns at once.
constexpr std::size_t kFewest = 10;
constexpr double kTurning_rad_per_s = 0.02;
/// Smaller turns prove a sensor: what is unexplained of a stuck one is all of them, of a negated
/// one twice as much.
constexpr double kProvingTurning_rad_per_s = 0.008;
/// A sensor that is later (or earlier) than this beyond four standard deviations is left out; one
/// that is within this and two is on time. Right data: up to 0.004 s, with a standard deviation of
/// 0.001 to 0.02 (simulated streets). Checked on the unit of KITTI drive 0005, which is 0.07
/// to 0.08 s late.
constexpr double kLate_s = 0.02;
constexpr double kOnTime_s = 0.04;
/// The share of the turns that may remain unexplained while the sensor is used, and the one below
/// which a sensor that was left out is used again.
constexpr double kMostUnexplained = 0.5;
constexpr double kUnexplained = 0.3;
/// Scans that fit clearly better with a sensor prove it.
constexpr int kProvingGains = 5;
/// Smallest cosine of the angle between the mean force and upwards: the sensor leans, and
/// accelerates.
constexpr double kLeastUpward = 0.5;

/// A sensor whose axes and unit may be others: registered = scale axes measured.
struct Conversion {
  Matrix3d axes = Matrix3d::Identity();
  double scale = 1.0;
};

/// The plausible mistakes: axes swapped or negated, degrees for radians or the opposite. Frames
/// that are right-handed come first: signs of axes about which little turned are thus theirs.
template <typename Visit>
void for_each_conversion(const Visit& visit) {
  for (const double handedness : {1.0, -1.0}) {
    std::array<int, 3> order = {0, 1, 2};
    do {
      for (int signs = 0; signs < 8; ++signs) {
        Matrix3d axes = Matrix3d::Zero();
        for (int i = 0; i < 3; ++i) axes(i, order[i]) = (signs >> i & 1) != 0 ? -1.0 : 1.0;
        if (handedness * axes.determinant() < 0.0) continue;
        for (const double scale : {1.0, kDegree_rad, 1.0 / kDegree_rad}) visit({axes, scale});
      }
    } while (std::ranges::next_permutation(order).found);
  }
}

/// Root mean square of vectors about their median, without the tenth that is farthest from it:
/// single samples may be wrong.
template <typename Turns, typename Value>
double deviation(const Turns& turns, const Value& value) {
  const std::size_t count = turns.size();
  Vector3d median;
  std::vector<double> sorted(count);
  for (int i = 0; i < 3; ++i) {
    std::ranges::transform(turns, sorted.begin(), [&](const auto& t) { return value(t)[i]; });
    std::ranges::nth_element(sorted, sorted.begin() + count / 2);
    median[i] = sorted[count / 2];
  }
  std::ranges::transform(turns, sorted.begin(),
                         [&](const auto& t) { return (value(t) - median).squaredNorm(); });
  std::ranges::sort(sorted);
  sorted.resize(count - count / 10);
  return std::sqrt(std::accumulate(sorted.begin(), sorted.end(), 0.0) /
                   static_cast<double>(sorted.size()));
}

/// How late the sensor's stamps are.
struct Lateness {
  double late_s = 0.0;
  double sigma_s = 0.0;
};

/// With a sensor's rates g(t) = w(t - late) + bias and the registered rates w,
///   w - g = late g' - bias,
/// solved by least squares; g' by central differences.
template <typename Turns>
Lateness lateness(const Turns& turns) {
  const std::size_t count = turns.size() - 2;
  Eigen::Matrix3Xd slope(3, count);
  Eigen::Matrix3Xd left(3, count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto& [before, at, after] = std::tie(turns[i], turns[i + 1], turns[i + 2]);
    slope.col(i) =
        (after.gyroscope_rad_per_s - before.gyroscope_rad_per_s) / (after.stamp_s - before.stamp_s);
    left.col(i) = at.registered_rad_per_s - at.gyroscope_rad_per_s;
  }
  slope.colwise() -= slope.rowwise().mean().eval();
  left.colwise() -= left.rowwise().mean().eval();
  const double late_s = slope.cwiseProduct(left).sum() / slope.squaredNorm();
  const double rest = (left - late_s * slope).squaredNorm() / static_cast<double>(left.size());
  return {late_s, std::sqrt(rest / slope.squaredNorm())};
}

/// The gyroscope's, by turns that agree.
template <typename Turns>
InertialCheck::Bias bias(const Turns& turns) {
  Vector3d sum = Vector3d::Zero();
  for (const auto& turn : turns) sum += turn.gyroscope_rad_per_s - turn.registered_rad_per_s;
  return {sum / static_cast<double>(turns.size()), turns.back().stamp_s - turns.front().stamp_s};
}

/// "x, -y, -z": which of the sensor's axes are the LiDAR's.
std::string axes_text(const Matrix3d& axes) {
  std::string text;
  for (int row = 0; row < 3; ++row) {
    Eigen::Index column = 0;
    axes.row(row).cwiseAbs().maxCoeff(&column);
    text += fmt::format("{}{}{}", row == 0 ? "" : ", ", axes(row, column) < 0.0 ? "-" : "",
                        "xyz"[column]);
  }
  return text;
}

std::string suggestion(const Conversion& fits) {
  if (fits.scale < 1.0) return "; degrees per second?";
  if (fits.scale > 1.0) return "; divided by 57.3 twice?";
  if (fits.axes.isIdentity()) return "";
  return fmt::format("; axes {}?", axes_text(fits.axes));
}

std::string late_text(double late_s) {
  constexpr double kMostLinear_s = 0.1;  // beyond, lateness() is not linear
  if (std::abs(late_s) > kMostLinear_s) return "its turns disagree with the scans; another clock?";
  return fmt::format("its clock is {:.2f} s {}", std::abs(late_s), late_s < 0.0 ? "early" : "late");
}

bool is_long_as_gravity(double length_mps2) {
  return std::abs(length_mps2 - kGravity_mps2) <= 0.5 * kGravity_mps2;
}

}  // namespace

bool is_gravity(const Vector3d& specific_force_mps2) {
  const double length_mps2 = specific_force_mps2.norm();
  return is_long_as_gravity(length_mps2) && specific_force_mps2.z() >= kLeastUpward * length_mps2;
}

void InertialCheck::refute() {
  agrees_ = false;
  is_proven_ = false;
  gains_ = 0;
  mean_innovation_ = 0.0;
  turns_.clear();
  if (complaint_.empty()) complaint_ = "its turns and forces disagree with the scans";
}

void InertialCheck::add_innovation(double innovation) {
  mean_innovation_ += kShareOfScan * (std::min(innovation, kMostOfScan) - mean_innovation_);
  if (mean_innovation_ > kMostMeanInnovation) refute();
}

void InertialCheck::contradict_gravity() {
  gravity_contradicts_ = true;
  complaint_ = "its forces contradict the path of the scans: it may have moved on the vehicle";
}

void InertialCheck::add_gain() { is_proven_ = ++gains_ >= kProvingGains; }

std::optional<InertialCheck::Bias> InertialCheck::compare_turns(const Turn& turn) {
  turns_.push_back(turn);
  if (turns_.size() > kCompared) turns_.pop_front();
  const bool is_new = agrees_ && !is_proven_;
  if (turns_.size() < (is_new ? kFewest : kCompared)) return std::nullopt;
  const double turning =
      deviation(turns_, [](const Turn& t) -> Vector3d { return t.registered_rad_per_s; });
  const double measured =
      deviation(turns_, [](const Turn& t) -> Vector3d { return t.gyroscope_rad_per_s; });
  const double unexplained = deviation(turns_, [](const Turn& t) {
    return Vector3d(t.registered_rad_per_s - t.gyroscope_rad_per_s);
  });
  const double most = std::max(turning, measured);
  const auto [late_s, sigma_s] = lateness(turns_);
  const double surely_late_s = std::max(0.0, std::abs(late_s) - 4.0 * sigma_s);
  const double least = is_new ? kProvingTurning_rad_per_s : kTurning_rad_per_s;
  const double share = is_new ? kMostUnexplained : kUnexplained;
  if (!is_proven_ && turning > least && unexplained < share * turning &&
      std::abs(late_s) + 2.0 * sigma_s < kOnTime_s) {
    agrees_ = true;
    is_proven_ = true;
    return bias(std::exchange(turns_, {}));
  }
  if (turns_.size() < kCompared) return std::nullopt;
  if (agrees_) {
    const bool is_late = surely_late_s > kLate_s;
    if (is_late || (most > kTurning_rad_per_s && unexplained > kMostUnexplained * most)) refute();
    if (is_late) complaint_ = late_text(late_s);
  } else if (turning > kTurning_rad_per_s) {
    explain_turns(measured, turning, unexplained, surely_late_s > kLate_s ? late_s : 0.0);
  }
  return std::nullopt;
}

/// Sets the complaint to what would make the turns agree.
void InertialCheck::explain_turns(double measured, double turning, double unexplained,
                                  double late_s) {
  Conversion best;
  for_each_conversion([&](const Conversion& tried) {
    const double left = deviation(turns_, [&](const Turn& t) {
      return Vector3d(t.registered_rad_per_s - tried.scale * (tried.axes * t.gyroscope_rad_per_s));
    });
    // Axes about which nothing turned stay as they are.
    if (left > 0.9 * unexplained) return;
    unexplained = left;
    best = tried;
  });
  const double fold = measured / turning;
  const bool fits = unexplained < kUnexplained * turning;
  if (fold < 0.05) {
    complaint_ = "it measures no turns where the scans turn";
  } else if (fits && best.scale != 1.0) {
    complaint_ = fmt::format("its turns disagree with the scans {:.0f}-fold{}",
                             std::max(fold, 1.0 / fold), suggestion(best));
  } else if (late_s != 0.0 && best.axes.isIdentity()) {
    complaint_ = late_text(late_s);
  } else {
    complaint_ =
        fmt::format("its turns disagree with the scans{}",
                    fits ? suggestion(best)
                         : "; another clock, or a sensor that leans (mounting in slam-options)?");
  }
}

void InertialCheck::complain_about_force(const Vector3d& specific_force_mps2) {
  const double length_mps2 = specific_force_mps2.norm();
  if (is_long_as_gravity(length_mps2)) {
    const bool is_down = specific_force_mps2.z() < -kLeastUpward * length_mps2;
    complaint_ = fmt::format("its forces at rest point {}, expected upwards; other axes or signs?",
                             is_down ? "downwards" : "sideways");
  } else {
    complaint_ =
        fmt::format("its forces of {:.2f} m/s^2 are not gravity's {:.2f}{}", length_mps2,
                    kGravity_mps2, length_mps2 < 2.0 && length_mps2 > 0.5 ? "; in g?" : "");
  }
}

}  // namespace hqslam::slam

#include "imu/inertial_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
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
constexpr double kTurning_rad_per_s = 0.02;
/// The share of the turns that may remain unexplained while the sensor is used, and the one below
/// which a sensor that was left out is used again.
constexpr double kMostUnexplained = 0.5;
constexpr double kUnexplained = 0.3;
/// Smallest cosine of the angle between the mean force and upwards: the sensor leans, and
/// accelerates.
constexpr double kLeastUpward = 0.5;

/// A sensor whose axes and unit may be others: registered = scale axes measured.
struct Conversion {
  Matrix3d axes = Matrix3d::Identity();
  double scale = 1.0;
};

/// The plausible mistakes: axes swapped or negated, degrees for radians or the opposite.
template <typename Visit>
void for_each_conversion(const Visit& visit) {
  std::array<int, 3> order = {0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      Conversion conversion{Matrix3d::Zero(), 1.0};
      for (int i = 0; i < 3; ++i) conversion.axes(i, order[i]) = (signs >> i & 1) != 0 ? -1.0 : 1.0;
      for (const double scale : {1.0, kDegree_rad, 1.0 / kDegree_rad}) {
        conversion.scale = scale;
        visit(conversion);
      }
    }
  } while (std::ranges::next_permutation(order).found);
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
  predictions_ = 0;
  mean_innovation_ = 0.0;
  turns_.clear();
  if (complaint_.empty()) complaint_ = "its turns and forces disagree with the scans";
}

void InertialCheck::add_innovation(double innovation) {
  ++predictions_;
  mean_innovation_ += kShareOfScan * (std::min(innovation, kMostOfScan) - mean_innovation_);
  if (mean_innovation_ > kMostMeanInnovation) refute();
}

void InertialCheck::compare_turns(const Vector3d& gyroscope_rad_per_s,
                                  const Vector3d& registered_rad_per_s) {
  turns_.push_back({gyroscope_rad_per_s, registered_rad_per_s});
  if (turns_.size() > kCompared) turns_.pop_front();
  if (turns_.size() < kCompared) return;
  const double turning =
      deviation(turns_, [](const Turn& t) -> Vector3d { return t.registered_rad_per_s; });
  const double measured =
      deviation(turns_, [](const Turn& t) -> Vector3d { return t.gyroscope_rad_per_s; });
  const double unexplained = deviation(turns_, [](const Turn& t) {
    return Vector3d(t.registered_rad_per_s - t.gyroscope_rad_per_s);
  });
  if (agrees_) {  // the registered turns follow the sensor's
    const double most = std::max(turning, measured);
    if (most > kTurning_rad_per_s && unexplained > kMostUnexplained * most) refute();
  } else if (turning > kTurning_rad_per_s && unexplained < kUnexplained * turning) {
    agrees_ = true;
    turns_.clear();
  } else if (turning > kTurning_rad_per_s) {
    explain_turns(measured, turning, unexplained);
  }
}

/// Sets the complaint to what would make the turns agree.
void InertialCheck::explain_turns(double measured, double turning, double unexplained) {
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
  } else {
    complaint_ = fmt::format("its turns disagree with the scans{}",
                             fits ? suggestion(best) : "; another clock?");
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

#pragma once

#include "hqslam/core/pose.h"
#include "testing.h"

namespace hqslam::test {

/// A body that moves with a constant twist for good, in closed form: a screw about a fixed axis.
///
/// The axis of rotation through the point c turns everything about it while it glides along it:
///   T(t) = T_start S(t),  S(t): p -> c + R(w t) (p - c) + (pitch t) a,  a = w / |w|,
///   c = w x v / |w|^2,  pitch = v . a.
/// It is written without the library's exponential, which it is there to test.
struct SteadyDrive {
  Pose T_start = Pose::Identity();
  Eigen::Vector3d velocity_mps = Eigen::Vector3d::Zero();    ///< in the body's frame
  Eigen::Vector3d turn_rad_per_s = Eigen::Vector3d::Zero();  ///< the same; not zero

  Pose at(double time_s) const {
    const double rate = turn_rad_per_s.norm();
    const Eigen::Vector3d axis = turn_rad_per_s / rate;
    const Eigen::Vector3d centre_m = turn_rad_per_s.cross(velocity_mps) / (rate * rate);
    const Eigen::Quaterniond turned(
        std::cos(rate * time_s / 2.0), std::sin(rate * time_s / 2.0) * axis.x(),
        std::sin(rate * time_s / 2.0) * axis.y(), std::sin(rate * time_s / 2.0) * axis.z());
    Pose moved = Pose::Identity();
    moved.linear() = turned.toRotationMatrix();
    moved.translation() = centre_m - turned * centre_m + velocity_mps.dot(axis) * time_s * axis;
    return T_start * moved;
  }
};

}  // namespace hqslam::test

#include "loops/levelling.h"

#include "slam/imu/accelerometer.h"
#include "slam/poses.h"

using namespace hqslam::slam;

namespace {

constexpr double kNode_m = 4.0;
constexpr int kNodes = 200;

Pose turned(const Eigen::Vector3d& turn_rad) {
  return exponential(Twist{Eigen::Vector3d::Zero(), turn_rad});
}

/// A path over level ground with a corner every 50 nodes, or straight, and what registrations that
/// each lean by a little make of it. (On a circle for good a bias looks like a lean.)
struct Path {
  std::vector<Pose> truth{Pose::Identity()};
  std::vector<Pose> registered{Pose::Identity()};
  std::vector<GravityAtNode> gravity;

  Path(bool has_corners, double lean_rad, const Eigen::Vector3d& bias_mps2) {
    for (int i = 1; i < kNodes; ++i) {
      const double turn_rad = has_corners && i % 50 > 40 ? 0.17 : 0.0;
      const Pose motion = Eigen::Translation3d(kNode_m, 0, 0) * turned({0, 0, turn_rad});
      truth.push_back(truth.back() * motion);
      registered.push_back(registered.back() * motion * turned({0, lean_rad, 0}));
      if (i % 6 != 0) continue;
      FeltGravity felt;
      felt.stamp_s = 0.5 * i;
      felt.gravity_mps2 = truth.back().linear().transpose() * kGravity - bias_mps2;
      felt.of_bias.setIdentity();
      gravity.push_back({static_cast<std::size_t>(i), felt});
    }
  }
};

double worst_lean_rad(const std::vector<Pose>& poses) {
  double worst = 0.0;
  for (const Pose& pose : poses) {
    worst = std::max(worst, std::acos(std::min(1.0, pose.linear()(2, 2))));
  }
  return worst;
}

}  // namespace

TEST_CASE("a path that leans by a little more with every metre is put upright") {
  constexpr double kLean_rad = 5e-4;  // a degree in 140 m
  for (const bool has_corners : {false, true}) {
    const Path path(has_corners, kLean_rad, Eigen::Vector3d::Zero());
    const std::vector<Pose> upright = slam::levelled(path.registered, path.gravity).value();
    REQUIRE(upright.size() == path.truth.size());
    CHECK(upright.front().isApprox(path.registered.front()));
    CHECK(worst_lean_rad(upright) < 0.1 * worst_lean_rad(path.registered));
    CHECK(worst_error_m(upright, path.truth) < 0.2 * worst_error_m(path.registered, path.truth));
  }
}

TEST_CASE("an accelerometer's bias is not taken for a lean, whether the sensor turns or not") {
  for (const auto& [has_corners, most_rad] : {std::pair(true, 1e-3), {false, 1e-6}}) {
    const Path path(has_corners, 0.0, kBias_mps2);
    CHECK(worst_lean_rad(*slam::levelled(path.registered, path.gravity)) < most_rad);
  }
}

TEST_CASE("a clock that is set back does no harm") {
  Path path(true, 5e-4, Eigen::Vector3d::Zero());
  for (std::size_t i = 20; i < path.gravity.size(); ++i) path.gravity[i].felt.stamp_s -= 1000.0;
  const std::vector<Pose> upright = slam::levelled(path.registered, path.gravity).value();
  CHECK(worst_lean_rad(upright) < 0.1 * worst_lean_rad(path.registered));
}

TEST_CASE("motions in the sensor's frame stay as they were, and so does a path without gravity") {
  const Path path(true, 5e-4, kBias_mps2);
  const std::vector<Pose> upright = slam::levelled(path.registered, path.gravity).value();
  for (std::size_t i = 1; i < upright.size(); ++i) {
    const Pose motion = upright[i - 1].inverse() * upright[i];
    CHECK((motion.translation() - Eigen::Vector3d(kNode_m, 0, 0)).norm() < 1e-9);
  }
  CHECK(slam::levelled(path.registered, {})->back().matrix() == path.registered.back().matrix());
}

TEST_CASE("an inertial sensor that moves on the vehicle levels nothing") {
  Path path(true, 5e-4, Eigen::Vector3d::Zero());
  REQUIRE(slam::levelled(path.registered, path.gravity));
  const Eigen::Matrix3d bent = turned({0, 0.035, 0}).linear();  // by two degrees
  for (std::size_t i = 15; i < path.gravity.size(); ++i) {
    path.gravity[i].felt.gravity_mps2 = bent * path.gravity[i].felt.gravity_mps2;
  }
  CHECK_FALSE(slam::levelled(path.registered, path.gravity));
}

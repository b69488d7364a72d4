#include "hqslam/core/angles.h"
#include "hqslam/evaluation/trajectory_error.h"
#include "testing.h"

namespace {

/// 300 poses a metre apart along x, ten a second.
Trajectory straight_drive() {
  Trajectory trajectory;
  for (int i = 0; i < 300; ++i) {
    trajectory.push_back({0.1 * i, pose_from_xyz_rpy({1.0 * i, 0.0, 0.0}, 0.0, 0.0, 0.0)});
  }
  return trajectory;
}

/// The drive as seen by an estimate that is displaced by `jump` between scans at - 1 and at.
Trajectory with_jump(Trajectory trajectory, std::size_t at, const Pose& jump) {
  const Pose T_before = trajectory[at].T_map_sensor;
  const Pose T_jump = T_before * jump * T_before.inverse();
  for (std::size_t i = at; i < trajectory.size(); ++i) {
    trajectory[i].T_map_sensor = T_jump * trajectory[i].T_map_sensor;
  }
  return trajectory;
}

Pose aside_m(double y) { return pose_from_xyz_rpy({0.0, y, 0.0}, 0.0, 0.0, 0.0); }

Trajectory scaled(Trajectory trajectory, double factor) {
  for (StampedPose& pose : trajectory) pose.T_map_sensor.translation() *= factor;
  return trajectory;
}

}  // namespace

// Windows of ten steps that hold the step from 99 to 100 begin at 90 to 99 and end at 100 to 109.
TEST_CASE("a jump is one slip, over the scans of all windows that hold it") {
  const std::vector<Slip> found =
      slips(with_jump(straight_drive(), 100, aside_m(0.5)), straight_drive());
  REQUIRE(found.size() == 1);
  CHECK(found[0].first == 90);
  CHECK(found[0].last == 109);
  CHECK(found[0].translation_m == doctest::Approx(0.5));
  CHECK(found[0].rotation_rad == doctest::Approx(0.0));
}

TEST_CASE("a slip is as large as its worst window, whichever that is") {
  // 0.9 m in the windows that hold the first jump alone, 0.4 m in those of both, then 0.5 m.
  const std::vector<Slip> found =
      slips(with_jump(with_jump(straight_drive(), 100, aside_m(0.9)), 105, aside_m(-0.5)),
            straight_drive());
  REQUIRE(found.size() == 1);
  CHECK(found[0].translation_m == doctest::Approx(0.9));
  const auto turned = [](double degrees) {
    return pose_from_xyz_rpy({0, 0, 0}, 0.0, 0.0, degrees * kDegree_rad);
  };
  const std::vector<Slip> turns =
      slips(with_jump(with_jump(straight_drive(), 100, turned(0.9)), 105, turned(-0.5)),
            straight_drive());
  REQUIRE(turns.size() == 1);
  CHECK(turns[0].rotation_rad == doctest::Approx(0.9 * kDegree_rad));
}

TEST_CASE("the limits are 0.3 m and 0.3 degrees, whatever the frame of the estimate") {
  const Pose T_elsewhere = pose_from_xyz_rpy({100.0, -50.0, 7.0}, 0.4, -1.0, 2.5);
  const auto count = [&](const Pose& jump) {
    Trajectory estimate = with_jump(straight_drive(), 100, jump);
    for (StampedPose& pose : estimate) pose.T_map_sensor = T_elsewhere * pose.T_map_sensor;
    return slips(estimate, straight_drive()).size();
  };
  CHECK(count(aside_m(0.299)) == 0);
  CHECK(count(aside_m(0.301)) == 1);
  CHECK(count(pose_from_xyz_rpy({0, 0, 0}, 0.0, 0.0, 0.299 * kDegree_rad)) == 0);
  CHECK(count(pose_from_xyz_rpy({0, 0, 0}, 0.0, 0.0, 0.301 * kDegree_rad)) == 1);
  CHECK(count(pose_from_xyz_rpy({0, 0, 0}, 0.301 * kDegree_rad, 0.0, 0.0)) == 1);
}

TEST_CASE("jumps whose windows do not touch are slips of their own, nearer ones are one") {
  const auto count = [](std::size_t second) {
    return slips(with_jump(with_jump(straight_drive(), 100, aside_m(0.5)), second, aside_m(0.5)),
                 straight_drive())
        .size();
  };
  // The first covers scans 90 to 109; the second begins ten scans before its jump.
  CHECK(count(120) == 1);
  CHECK(count(121) == 2);
  CHECK(count(200) == 2);
}

TEST_CASE("an estimate lost for a drive has one slip, a slow drift none; rates are per 100 km") {
  const std::vector<Slip> lost = slips(scaled(straight_drive(), 1.04), straight_drive());
  REQUIRE(lost.size() == 1);  // 0.4 m in ten metres
  CHECK(lost[0].first == 0);
  CHECK(lost[0].last == 299);
  CHECK(slips(scaled(straight_drive(), 1.02), straight_drive()).empty());
  CHECK(slips_per_100_km(3, 1500.0) == doctest::Approx(200.0));
  CHECK(slips_per_100_km(0, 1500.0) == 0.0);
  CHECK(slips_per_100_km(3, 0.0) == 0.0);
}

TEST_CASE("windows are of scans, whatever the rate of the true poses") {
  Trajectory often;  // 75 a second
  for (int i = 0; i < 2240; ++i) {
    often.push_back({i / 75.0, pose_from_xyz_rpy({i / 7.5, 0.0, 0.0}, 0.0, 0.0, 0.0)});
  }
  CHECK(slips(with_jump(straight_drive(), 100, aside_m(5.0)), often).size() == 1);
  CHECK(slips(scaled(straight_drive(), 1.05), often).size() == 1);
  Trajectory seldom;  // once a second
  for (std::size_t i = 0; i < 300; i += 10) seldom.push_back(straight_drive()[i]);
  CHECK(slips(scaled(straight_drive(), 1.02), seldom).empty());
}

TEST_CASE("a scan without a pose spoils no window, a pose that is not a number does") {
  Trajectory estimate = straight_drive();
  estimate.erase(estimate.begin() + 100);
  CHECK(slips(estimate, straight_drive()).empty());
  estimate[150].T_map_sensor.translation().x() = std::numeric_limits<double>::quiet_NaN();
  CHECK(slips(estimate, straight_drive()).size() == 1);
}

TEST_CASE("an estimate that is two percent long drifts by two percent") {
  const Drift of_scale =
      drift(relative_pose_error(scaled(straight_drive(), 1.02), straight_drive(), kDriftPiece_m));
  CHECK(of_scale.pieces == 200);
  CHECK(of_scale.translation_percent == doctest::Approx(2.0));
  CHECK(of_scale.rotation_deg_per_100m == doctest::Approx(0.0));
}

TEST_CASE("a hundredth of a degree per metre is a degree per 100 m, over pieces of any length") {
  Trajectory estimate = straight_drive();
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    const double roll_rad = 0.01 * kDegree_rad * static_cast<double>(i);
    estimate[i].T_map_sensor = pose_from_xyz_rpy({static_cast<double>(i), 0, 0}, roll_rad, 0, 0);
  }
  for (const double piece_m : {50.0, 100.0}) {
    const Drift rolling = drift(relative_pose_error(estimate, straight_drive(), piece_m));
    CHECK(rolling.translation_percent == doctest::Approx(0.0));
    CHECK(rolling.rotation_deg_per_100m == doctest::Approx(1.0));
  }
}

// 200 pieces begin at poses 0 to 199. Those from 50 to 149 hold the jump of 0.5 m: 0.5 % each.
// Those that end before scan 140 begin at 0 to 39, those that begin after scan 159 at 160 to 199.
TEST_CASE("pieces that share a scan with a slip are left out on demand") {
  const Trajectory estimate = with_jump(straight_drive(), 150, aside_m(0.5));
  const RelativePoseError error = relative_pose_error(estimate, straight_drive(), kDriftPiece_m);
  CHECK(drift(error).translation_percent == doctest::Approx(0.25));
  const Drift elsewhere = drift(error, slips(estimate, straight_drive()));
  CHECK(elsewhere.pieces == 80);
  CHECK(elsewhere.translation_percent == doctest::Approx(0.0));
  CHECK(drift(error, {{0, 299, 1.0, 0.0}}).pieces == 0);
}

TEST_CASE("limits that are not positive and trajectories of different times are refused") {
  const Trajectory drive = straight_drive();
  Trajectory later = drive;
  for (StampedPose& pose : later) pose.stamp_s += 1000.0;
  CHECK(refused_with([&] { slips(later, drive); }, "at least 2 poses", "found 0"));
}

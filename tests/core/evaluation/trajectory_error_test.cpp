#include "hqslam/evaluation/trajectory_error.h"

#include "hqslam/core/angles.h"
#include "testing.h"

namespace {

/// 201 poses one metre of path apart, through curves and over hills.
Trajectory a_drive() {
  Trajectory trajectory;
  Pose T_map_sensor = Pose::Identity();
  for (int i = 0; i <= 200; ++i) {
    trajectory.push_back({0.1 * i, T_map_sensor});
    T_map_sensor = T_map_sensor * pose_from_xyz_rpy({1.0, 0.0, 0.0}, 0.01 * std::sin(0.3 * i),
                                                    0.02 * std::cos(0.07 * i),
                                                    0.06 * std::sin(0.045 * i + 0.5));
  }
  return trajectory;
}

/// The drive as an odometry that drifts might see it, in a frame of its own.
Trajectory an_estimate() {
  const Trajectory drive = a_drive();
  Trajectory trajectory;
  Pose T_map_sensor = pose_from_xyz_rpy({5.0, -3.0, 2.0}, 0.1, -0.2, 0.7);
  for (std::size_t i = 0; i < drive.size(); ++i) {
    const double k = static_cast<double>(i);
    if (i > 0) {
      const Pose motion = drive[i - 1].T_map_sensor.inverse() * drive[i].T_map_sensor;
      T_map_sensor =
          T_map_sensor * motion *
          pose_from_xyz_rpy({0.004 * std::sin(1.1 * k), 0.003, 0.005 * std::cos(0.9 * k)},
                            0.0004 * std::sin(0.2 * k), 0.0003 * std::cos(1.7 * k), 0.0005);
    }
    trajectory.push_back({drive[i].stamp_s + 0.003, T_map_sensor});
  }
  return trajectory;
}

Trajectory with_stamps(const std::vector<double>& stamps_s) {
  Trajectory trajectory;
  for (const double stamp_s : stamps_s) trajectory.push_back({stamp_s, Pose::Identity()});
  return trajectory;
}

}  // namespace

TEST_CASE("statistics of a few numbers are those done by hand") {
  const Statistics odd = statistics_of({3.0, 0.0, 4.0});
  CHECK(odd.rmse == doctest::Approx(std::sqrt(25.0 / 3.0)));
  CHECK(odd.mean == doctest::Approx(7.0 / 3.0));
  CHECK(odd.median == 3.0);
  CHECK(odd.max == 4.0);
  CHECK(statistics_of({1.0, 2.0, 10.0, 4.0}).median == 3.0);
  CHECK(statistics_of({}).rmse == 0.0);
  CHECK(statistics_of({}).max == 0.0);
  CHECK(statistics_of({3.0}).p95 == 3.0);
  std::vector<double> values;
  for (int i = 20; i >= 1; --i) values.push_back(i);
  CHECK(statistics_of(values).p95 == 19.0);
}

TEST_CASE("stamps are paired with the nearest, each reference once, none too far apart") {
  PosePairs pairs = associate(with_stamps({0.0, 0.98, 1.01, 1.5, 2.04, 9.0}),
                              with_stamps({-5.0, 0.01, 1.0, 2.0, 3.0}), 0.05);
  CHECK(pairs.estimate == std::vector<std::size_t>{0, 2, 4});
  CHECK(pairs.reference == std::vector<std::size_t>{1, 2, 3});
  CHECK(associate({}, with_stamps({0.0}), 1.0).estimate.empty());
  CHECK(associate(with_stamps({0.0}), {}, 1.0).estimate.empty());
  // A stamp that the reference has twice does not end the pairing.
  pairs = associate(with_stamps({0, 1, 2, 3}), with_stamps({0, 1, 1, 2, 3}), 0.05);
  CHECK(pairs.estimate == std::vector<std::size_t>{0, 1, 2, 3});
  CHECK(pairs.reference == std::vector<std::size_t>{0, 2, 3, 4});
}

TEST_CASE("absolute errors after each alignment agree with evo") {
  const Trajectory estimate = an_estimate();
  const Trajectory reference = a_drive();
  const AbsolutePoseError none = absolute_pose_error(estimate, reference, Alignment::kNone);
  const AbsolutePoseError first = absolute_pose_error(estimate, reference, Alignment::kFirstPose);
  const AbsolutePoseError se3 = absolute_pose_error(estimate, reference, Alignment::kSe3);
  // Made with evo 1.38: APE, translation part and rotation angle in degrees.
  CHECK(none.translation_statistics.rmse == doctest::Approx(52.657774789).epsilon(1e-8));
  CHECK(none.rotation_statistics.max == doctest::Approx(radians(47.836904964)).epsilon(1e-8));
  CHECK(first.translation_statistics.rmse == doctest::Approx(3.058708220).epsilon(1e-8));
  CHECK(first.rotation_statistics.rmse == doctest::Approx(radians(3.247434879)).epsilon(1e-8));
  CHECK(se3.translation_statistics.rmse == doctest::Approx(0.658186919).epsilon(1e-8));
  CHECK(se3.translation_statistics.mean == doctest::Approx(0.630367623).epsilon(1e-8));
  CHECK(se3.translation_statistics.median == doctest::Approx(0.603841948).epsilon(1e-8));
  CHECK(se3.translation_statistics.max == doctest::Approx(1.025101855).epsilon(1e-8));
  CHECK(se3.rotation_statistics.rmse == doctest::Approx(radians(1.635884686)).epsilon(1e-8));
  CHECK(se3.rotation_statistics.median == doctest::Approx(radians(1.409616810)).epsilon(1e-8));
}

TEST_CASE("relative errors over a stretch agree with evo, one longer than the path gives none") {
  const RelativePoseError error = relative_pose_error(an_estimate(), a_drive(), 20.0);
  CHECK(error.stretch_m == 20.0);
  REQUIRE(error.translation_m.size() == 181);
  // Made with evo 1.38: RPE, all pairs, delta 20 m, tolerance 1 %.
  CHECK(error.translation_statistics.rmse == doctest::Approx(0.151059479).epsilon(1e-8));
  CHECK(error.translation_statistics.median == doctest::Approx(0.150954999).epsilon(1e-7));
  CHECK(error.translation_statistics.max == doctest::Approx(0.159442497).epsilon(1e-7));
  CHECK(error.rotation_statistics.rmse == doctest::Approx(radians(0.593686206)).epsilon(1e-7));
  CHECK(error.rotation_statistics.max == doctest::Approx(radians(0.617860397)).epsilon(1e-7));
  CHECK(relative_pose_error(an_estimate(), a_drive(), 500.0).translation_m.empty());
}

TEST_CASE("a straight line and a standing sensor are aligned by their orientations") {
  Trajectory line;
  Trajectory standing;
  for (int i = 0; i < 20; ++i) {
    line.push_back({0.1 * i, pose_from_xyz_rpy({0.5 * i, 0, 0}, 0.3, 0, 0)});
    standing.push_back({0.1 * i, pose_from_xyz_rpy({1, 2, 3}, 0.1, 0.2, 0.3)});
  }
  const Pose T = pose_from_xyz_rpy({3, 2, 1}, 1.0, 0.5, -2.0);
  for (const Trajectory& trajectory : {line, standing}) {
    Trajectory moved = trajectory;
    for (StampedPose& pose : moved) pose.T_map_sensor = T * pose.T_map_sensor;
    const AbsolutePoseError error = absolute_pose_error(moved, trajectory, Alignment::kSe3);
    CHECK(error.translation_statistics.max < 1e-6);
    CHECK(error.rotation_statistics.max < 1e-6);
  }
}

TEST_CASE("of a path that is nearly a line an alignment by positions gives no rotation") {
  const auto wavy = [](double across_m, int seed) {
    Trajectory path;
    for (int i = 0; i < 60; ++i) {
      path.push_back({0.1 * i, pose_from_xyz_rpy({0.5 * i, across_m * std::sin(0.1 * i),
                                                  0.003 * std::sin(i * i + seed)},
                                                 0, 0, 0)});
    }
    return path;
  };
  const AbsolutePoseError straight =
      absolute_pose_error(wavy(0.003, 1), wavy(-0.003, 2), Alignment::kSe3);
  CHECK_FALSE(straight.is_rotation_known);
  CHECK(straight.rotation_statistics.rmse * kDegreesPerRadian > 10.0);
  const AbsolutePoseError curved = absolute_pose_error(wavy(1, 1), wavy(1, 2), Alignment::kSe3);
  CHECK(curved.is_rotation_known);
  CHECK(curved.rotation_statistics.rmse * kDegreesPerRadian < 1.0);
  CHECK(absolute_pose_error(wavy(0.003, 1), wavy(-0.003, 2), Alignment::kFirstPose)
            .is_rotation_known);
  CHECK(absolute_pose_error(an_estimate(), a_drive(), Alignment::kSe3).is_rotation_known);
}

TEST_CASE("mirrored positions are aligned by a rotation, not by a reflection") {
  Trajectory mirrored = a_drive();
  for (StampedPose& pose : mirrored) pose.T_map_sensor.translation().y() *= -1.0;
  const AbsolutePoseError error = absolute_pose_error(mirrored, a_drive(), Alignment::kSe3);
  CHECK(error.aligned_estimate.front().T_map_sensor.linear().determinant() == doctest::Approx(1.0));
  CHECK(error.translation_statistics.rmse > 1.0);
}

TEST_CASE("an alignment is known by its name") {
  for (const Alignment alignment : {Alignment::kNone, Alignment::kFirstPose, Alignment::kSe3}) {
    CHECK(alignment_from_name(name(alignment)) == alignment);
  }
  CHECK(refused_with([] { alignment_from_name("sim3"); }, "none, first or se3", "'sim3'"));
}

TEST_CASE("trajectories of different times and stretches of no length are refused") {
  const Trajectory drive = a_drive();
  Trajectory later = drive;
  for (StampedPose& pose : later) pose.stamp_s += 1000.0;
  CHECK(refused_with([&] { absolute_pose_error(later, drive, Alignment::kSe3); },
                     "at least 3 poses", "0.02 s", "found 0"));
  CHECK(refused_with([&] { absolute_pose_error({drive[0]}, drive, Alignment::kNone); },
                     "at least 2 poses", "found 1"));
  CHECK(refused_with([&] { relative_pose_error(drive, drive, 0.0); }, "stretch_m", "positive",
                     "found 0"));
}

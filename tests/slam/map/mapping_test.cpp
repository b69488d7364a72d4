#include "map/mapping.h"

#include "map/rooms.h"
#include "slam/village.h"

using slam::Status;

namespace {

/// An expected state with standard deviations of the pose in metres and radians.
slam::MotionState expected_at(const Pose& T_map_sensor, double sigma = 0.3) {
  slam::MotionState state;
  state.T_map_sensor = T_map_sensor;
  state.covariance.diagonal() << slam::Vector6::Constant(sigma * sigma), slam::Vector6::Constant(1);
  return state;
}

/// A map of the yard from eleven places along its length, whose frame is that of the first, moved.
struct MappedYard {
  SensorModel sensor = small_sensor(32, 1024);
  Yard yard;
  Pose T_map_yard;
  slam::Mapping mapping{slam::MappingOptions{}};

  explicit MappedYard(const Yard& yard_ = {}, const Pose& T_map_first = Pose::Identity())
      : yard(yard_), T_map_yard(T_map_first * yard_pose(-5, 0, 0).inverse()) {
    for (int i = 0; i <= 10; ++i) {
      const Pose T_yard_sensor = yard_pose(-5 + i, 0, 0);
      mapping.insert(features_at(T_yard_sensor), T_map_yard * T_yard_sensor, {});
    }
  }
  slam::MapFeatures features_at(const Pose& T_yard_sensor) const {
    return features_of(yard.scan(sensor, T_yard_sensor), sensor);
  }
  slam::MappingResult registered(const Pose& T_yard_sensor, const Pose& T_map_predicted,
                                 double sigma = 0.3) const {
    return mapping.register_scan(features_at(T_yard_sensor), expected_at(T_map_predicted, sigma),
                                 T_map_predicted);
  }
};

void add(double x, double y, double z, std::vector<slam::FeaturePoint>& to, int row = 0) {
  to.push_back({{static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)}, 0.0F, row});
}

/// A road and two walls, measured from 1.7 m above the road, from `offset_m` on.
/// rise_m(y): of the ground.
slam::MapFeatures road_with(double offset_m, double spacing_m, const auto& rise_m) {
  slam::MapFeatures result;
  for (double along = -10.0 + offset_m; along < 10.0; along += spacing_m) {
    for (double y = -6.0 + offset_m; y < 6.0; y += spacing_m) {
      add(along, y, -1.7 + rise_m(y), result.ground);
    }
    for (double z = -1.0; z < 3.0; z += spacing_m) {
      add(along, -7.0, z, result.surfaces);
      add(11.0, along, z, result.surfaces);
    }
  }
  result.ground_to_register = result.ground;
  result.surfaces_to_register = result.surfaces;
  return result;
}

/// A road with a step on its left side.
slam::MapFeatures road(double offset_m, double step_m) {
  return road_with(offset_m, 0.4, [&](double y) { return y > 4.5 ? step_m : 0.0; });
}

/// A road that rises at 45 degrees on its left side.
slam::MapFeatures beside_a_bank(double offset_m) {
  return road_with(offset_m, 0.5, [](double y) { return std::max(0.0, y - 3.0); });
}

/// A strip of road of 80 points between banks of 45 degrees, and a wall at its end.
/// rise_m: error of the height of the banks.
slam::MapFeatures between_banks(double offset_m, double rise_m) {
  constexpr double kSpacing_m = 0.4;
  slam::MapFeatures result;
  for (double x = -4.0 + offset_m; x < 4.0; x += kSpacing_m) {
    for (double y = -0.7 + offset_m; y < 0.7; y += kSpacing_m) add(x, y, -1.7, result.ground);
    for (double up = 0.3 + offset_m; up < 4.0; up += kSpacing_m) {
      for (const int side : {-1, 1}) {
        add(x, side * (1.0 + up), up - 1.7 + rise_m, result.surfaces);
        add(5.0, side * up, x, result.surfaces);
      }
    }
  }
  result.ground_to_register = result.ground;
  result.surfaces_to_register = result.surfaces;
  return result;
}

/// The estimated roll of a scan whose points on the road are between those of the map.
double roll_beside_a_bank_rad(const slam::MappingOptions& options) {
  slam::Mapping mapping{options};
  mapping.insert(beside_a_bank(0.25), Pose::Identity(), {});
  const auto result = mapping.register_scan(beside_a_bank(0.0), expected_at(Pose::Identity()),
                                            Pose::Identity(), slam::SearchFrom::kRecognizedPlace);
  REQUIRE(result.status == Status::kOk);
  return roll_pitch_yaw_rad(result.state.T_map_sensor).x();
}

}  // namespace

TEST_CASE("a map that is put into voxels of another size stays where it is") {
  MappedYard mapped;
  const Pose T_yard_sensor = yard_pose(2.3, 0.4, 0.1);
  const Pose T_map_sensor = mapped.T_map_yard * T_yard_sensor;
  const auto points = [&] { return mapped.mapping.map().planes.size(); };
  const std::size_t in_streets = points();
  mapped.mapping.change_options(slam::in_rooms({}));
  CHECK(points() == in_streets);
  const auto found = mapped.registered(T_yard_sensor, T_map_sensor);
  CHECK((found.state.T_map_sensor.translation() - T_map_sensor.translation()).norm() < 0.02);
  const auto scan = scan_features(mapped.yard.scan(mapped.sensor, T_yard_sensor), mapped.sensor);
  mapped.mapping.insert(slam::map_features(scan, mapped.mapping.options()), T_map_sensor, {});
  const std::size_t in_rooms = points();
  CHECK(in_rooms > in_streets);
  mapped.mapping.change_options({});
  CHECK(points() < in_rooms);
}

TEST_CASE("a given map keeps its points, be it of rooms or of streets") {
  const MappedYard mapped;
  slam::FeatureMaps map(slam::in_rooms({}));
  map.planes.insert(mapped.mapping.map().planes.points_m());
  const std::size_t points = map.planes.size();
  slam::Mapping located({}, std::move(map));
  for (const slam::MappingOptions& options : {slam::in_rooms({}), slam::MappingOptions()}) {
    located.change_options(options);
    CHECK(located.options().planar_leaf_m == options.planar_leaf_m);
    CHECK(located.map().planes.size() == points);
  }
}

TEST_CASE("a scan is located in the map from a rough prediction, as well far from its origin") {
  // LeGO-LOAM weighs planar features by their distance from the map's origin.
  for (const Pose& T_map_first :
       {Pose(Pose::Identity()), pose_from_xyz_rpy({4000, -3000, 50}, 0, 0, 1.0)}) {
    const MappedYard mapped({}, T_map_first);
    const Pose T_yard_sensor = yard_pose(0.3, 0.4, 0.1);
    const Pose truth = mapped.T_map_yard * T_yard_sensor;
    const auto result = mapped.registered(
        T_yard_sensor, truth * pose_from_xyz_rpy({0.2, -0.15, 0.05}, 0.01, -0.01, 0.02));
    CHECK(result.status == Status::kOk);
    CHECK((result.state.T_map_sensor.translation() - truth.translation()).norm() < 0.03);
    CHECK(rotation_angle_rad(result.state.T_map_sensor.inverse() * truth) < 0.003);
  }
}

TEST_CASE("ground that bends between the points of the map does not tilt the scan") {
  const double lenient_rad = roll_beside_a_bank_rad(
      {.max_ground_residual_m = slam::MappingOptions{}.max_plane_residual_m});
  CHECK(std::abs(lenient_rad) > 1e-4);
  CHECK(std::abs(roll_beside_a_bank_rad({})) < 0.1 * std::abs(lenient_rad));
}

TEST_CASE("ground that fits badly on one side hardly tilts the scan") {
  // Points more than 4.5 m to the left are a kerb's height lower in the scan than in the map.
  const auto roll_rad = [](double trusted_residual_m) {
    slam::Mapping mapping{{.trusted_residual_m = trusted_residual_m}};
    mapping.insert(road(0.1, 0.0), Pose::Identity(), {});
    const auto result =
        mapping.register_scan(road(0.0, -0.12), expected_at(Pose::Identity()), Pose::Identity());
    REQUIRE(result.status == Status::kOk);
    return roll_pitch_yaw_rad(result.state.T_map_sensor).x();
  };
  const double plain_rad = roll_rad(1000.0);
  CHECK(std::abs(plain_rad) > 2e-3);
  CHECK(std::abs(roll_rad(slam::MappingOptions{}.trusted_residual_m)) < 0.1 * std::abs(plain_rad));
}

TEST_CASE("flat views of the ground alone are no near ground") {
  const auto found = [](double rise_m) {
    slam::Mapping mapping{slam::MappingOptions{}};
    const auto risen_m = [=](double) { return rise_m; };
    mapping.insert(road_with(0.1, 0.4, risen_m), Pose::Identity(), {});
    return mapping.register_scan(road_with(0.0, 0.4, risen_m), expected_at(Pose::Identity()),
                                 Pose::Identity());
  };
  CHECK(found(0.0).has_near_ground);
  CHECK(found(1.65).has_ground);
  CHECK_FALSE(found(1.65).has_near_ground);
}

TEST_CASE("a strip of ground determines the height, inclined surfaces beside it do not") {
  slam::Mapping mapping{slam::MappingOptions{}};
  mapping.insert(between_banks(0.2, 0.0), Pose::Identity(), {});
  const slam::MapFeatures scan = between_banks(0.0, 0.1);
  REQUIRE(scan.ground.size() < 100);
  const auto result = mapping.register_scan(scan, expected_at(Pose::Identity()), Pose::Identity());
  REQUIRE(result.status != Status::kTooFewFeatures);
  CHECK(std::abs(result.state.T_map_sensor.translation().z()) < 0.005);
}

TEST_CASE("a place met again with drift is matched with only when it was taken up again") {
  // The yard, then 250 m of path elsewhere, then the yard again, where it has drifted by 0.4 m.
  MappedYard mapped;
  for (int i = 1; i <= 5; ++i) {
    const slam::MapFeatures elsewhere = road(0.0, 0.0);
    mapped.mapping.insert(elsewhere, pose_from_xyz_rpy({50.0 * i, 500.0, 0.0}, 0, 0, 0), {});
  }
  const Pose T_yard_sensor = yard_pose(0.3, 0.4, 0.1);
  const Pose truth = mapped.T_map_yard * T_yard_sensor;
  const Pose drifted = truth * pose_from_xyz_rpy({0.4, 0.0, 0.0}, 0, 0, 0);
  slam::MapPoints left_window = mapped.mapping.slide_window();
  const auto before = mapped.registered(T_yard_sensor, drifted);
  CHECK(before.status == Status::kTooFewFeatures);
  CHECK(before.state.T_map_sensor.isApprox(drifted));
  mapped.mapping.restore_to_window(std::move(left_window));
  const auto after = mapped.registered(T_yard_sensor, drifted);
  CHECK(after.status == Status::kOk);
  CHECK((after.state.T_map_sensor.translation() - truth.translation()).norm() < 0.03);
}

TEST_CASE("in an endless corridor the motion along it is held at its prediction") {
  const MappedYard mapped({.half_width_m = 4.0, .pillars = false, .end_walls = false});
  const Pose predicted = mapped.T_map_yard * yard_pose(0.4, 0.0, 0.01);
  // The accuracy with which a car's next scan is predicted.
  const auto result = mapped.registered(yard_pose(0.0, 0.2, 0.0), predicted, 0.03);
  CHECK(result.status == Status::kDegenerate);
  CHECK(result.state.T_map_sensor.translation().x() ==
        doctest::Approx(predicted.translation().x()).epsilon(0.02));
  CHECK(result.state.T_map_sensor.translation().y() == doctest::Approx(0.2).epsilon(0.2));
}

TEST_CASE("a corridor whose normals lean at random is degenerate, whatever they feign") {
  // Points are 5 cm off the walls and the floor. Their normals feign more than kMinObservableShare
  // of the information about the motion along it.
  const auto corridor = [](double offset_m, unsigned seed) {
    std::mt19937 generator(seed);
    std::normal_distribution<double> rough_m(0.0, 0.05);
    slam::MapFeatures result;
    for (double along_m = -15.0 + offset_m; along_m < 15.0; along_m += 0.3) {
      for (double across_m = -1.5 + offset_m; across_m < 1.5; across_m += 0.3) {
        add(along_m, across_m, -1.7 + rough_m(generator), result.ground);
        for (const double side : {-1.7, 1.7}) {
          add(along_m, side + rough_m(generator), across_m, result.surfaces);
        }
      }
    }
    result.ground_to_register = result.ground;
    result.surfaces_to_register = result.surfaces;
    return result;
  };
  slam::Mapping mapping{slam::MappingOptions{}};
  mapping.insert(corridor(0.1, 1), Pose::Identity(), {});
  const auto result = mapping.register_scan(corridor(0.0, 2), expected_at(Pose::Identity(), 0.03),
                                            Pose::Identity());
  CHECK(result.status == Status::kDegenerate);
}

TEST_CASE("rings on a bare floor do not hold the sensor back") {
  // Over an endless floor every scan has the same rings, which must not imply that the sensor
  // stands.
  const MappedYard mapped({.half_width_m = 1000.0, .pillars = false, .end_walls = false});
  const Pose predicted = mapped.T_map_yard * yard_pose(6.0, 0.0, 0.0);
  const auto result = mapped.registered(yard_pose(6.0, 0.0, 0.0), predicted);
  CHECK(result.status == Status::kDegenerate);
  CHECK((result.state.T_map_sensor.translation() - predicted.translation()).norm() < 0.01);
}

TEST_CASE("posts in open land determine position and heading") {
  // A road without walls, and six posts around it, each in one row at another height.
  const auto seen_from = [](double offset_m, double height_m) {
    slam::MapFeatures scan = road_with(offset_m, 0.4, [](double) { return 0.0; });
    scan.surfaces.clear();
    scan.surfaces_to_register.clear();
    const std::pair<double, double> posts_m[] = {{12, 3},  {9, -8},  {-4, 11},
                                                 {-13, 5}, {-7, -9}, {15, -2}};
    for (const auto& [x, y] : posts_m) {
      for (int i = 0; i < 3; ++i) add(x, y, -1.0 + 0.5 * i + height_m, scan.posts, i);
    }
    scan.posts_to_register = scan.posts;
    return scan;
  };
  slam::Mapping mapping{slam::MappingOptions{}};
  mapping.insert(seen_from(0.0, 0.0), Pose::Identity(), {});
  const slam::MapFeatures scan = seen_from(0.1, 0.1);
  const Pose wrong = pose_from_xyz_rpy({0.25, -0.2, 0.05}, 0.0, 0.0, 0.02);
  const auto located = mapping.register_scan(scan, expected_at(wrong), wrong);
  CHECK(located.status == Status::kOk);
  CHECK(located.edge_correspondences == 18);
  CHECK(located.state.T_map_sensor.translation().norm() < 0.01);
  CHECK(rotation_angle_rad(located.state.T_map_sensor) < 0.001);

  slam::MapFeatures without = scan;
  without.posts_to_register.clear();
  CHECK(mapping.register_scan(without, expected_at(wrong), wrong).status == Status::kDegenerate);
}

TEST_CASE("a rotation on the spot makes a keyframe, a short step does not") {
  slam::Mapping mapping{slam::MappingOptions{}};
  CHECK(mapping.is_keyframe(Pose::Identity()));
  mapping.insert(slam::MapFeatures{}, Pose::Identity(), {});
  CHECK(!mapping.is_keyframe(pose_from_xyz_rpy({0.2, 0, 0}, 0, 0, 0.1)));
  CHECK(mapping.is_keyframe(pose_from_xyz_rpy({0, 0, 0}, 0, 0, 0.25)));
  CHECK(mapping.is_keyframe(pose_from_xyz_rpy({0.31, 0, 0}, 0, 0, 0)));
}

TEST_CASE("in a map of one scan, whose rings of ground make no planes, all else suffices") {
  const auto scan_from = [](double x_m, double grid_m) {
    slam::MapFeatures features;
    for (const double radius_m : {5.0, 9.0, 14.0, 20.0, 27.0}) {
      for (int i = 0; i < 400; ++i) {
        const double angle_rad = 2.0 * M_PI * i / 400;
        add(radius_m * std::cos(angle_rad), radius_m * std::sin(angle_rad), -1.7, features.ground);
      }
    }
    for (double along = -9.0 + grid_m; along < 9.0; along += 0.8) {
      for (double z = -1.0 + grid_m; z < 3.0; z += 0.4) {
        add(along - x_m, -7.0, z, features.surfaces);
        add(11.0 - x_m, along, z, features.surfaces);
      }
    }
    features.ground_to_register = features.ground;
    features.surfaces_to_register = features.surfaces;
    return features;
  };
  const Pose ahead = pose_from_xyz_rpy({0.5, 0.0, 0.0}, 0.0, 0.0, 0.0);
  slam::Mapping mapping{slam::MappingOptions{}};
  mapping.insert(scan_from(0.0, 0.0), Pose::Identity(), {});
  const auto status = [&] {
    return mapping.register_scan(scan_from(0.5, 0.1), expected_at(ahead), ahead).status;
  };
  CHECK(slam::is_registered(status()));
  mapping.insert(scan_from(0.0, 0.0), Pose::Identity(), {});
  CHECK(status() == Status::kTooFewFeatures);
}

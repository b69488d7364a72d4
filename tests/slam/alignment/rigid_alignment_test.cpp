#include "alignment/rigid_alignment.h"

#include "slam/random_unit.h"

using namespace hqslam::slam;

namespace {

/// Points of random planes, moved so that `T` brings them onto the planes.
std::vector<PlaneConstraint> constraints_of(const Pose& T, int count, unsigned seed) {
  std::mt19937 generator(seed);
  std::vector<PlaneConstraint> result;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d normal =
        (random_vector(generator) + Eigen::Vector3d(0, 0, 0.1)).normalized();
    const Eigen::Vector3d on_plane =
        random_vector(generator).cwiseProduct(Eigen::Vector3d(20, 20, 3));
    result.push_back({T.inverse() * on_plane, normal, normal.dot(on_plane), 0.5 + 0.01 * (i % 50)});
  }
  return result;
}

MotionParameters some_parameters() {
  return (MotionParameters() << 0.3, -0.4, 0.2, 0.1, -0.05, 0.08).finished();
}

}  // namespace

TEST_CASE("parameters and pose are two forms of one motion") {
  const MotionParameters p = some_parameters();
  CHECK(parameters_of(pose_of(p)).isApprox(p, 1e-6));
}

TEST_CASE("analytic Jacobians equal central differences") {
  const auto constraints = constraints_of(Pose::Identity(), 40, 1);
  MotionParameters p = some_parameters();
  double* blocks[2] = {p.data(), p.data() + 3};
  std::vector<double> residuals(40);
  std::vector<double> in_plane(40 * 3);
  std::vector<double> out_of_plane(40 * 3);
  double* jacobians[2] = {in_plane.data(), out_of_plane.data()};
  evaluate(constraints, blocks, residuals.data(), jacobians);
  constexpr double kStep = 1e-6;
  for (int block = 0; block < 2; ++block) {
    for (int k = 0; k < 3; ++k) {
      std::vector<double> above(40);
      std::vector<double> below(40);
      blocks[block][k] += kStep;
      evaluate(constraints, blocks, above.data(), nullptr);
      blocks[block][k] -= 2 * kStep;
      evaluate(constraints, blocks, below.data(), nullptr);
      blocks[block][k] += kStep;
      for (int i = 0; i < 40; ++i) {
        const double numeric = (above[i] - below[i]) / (2 * kStep);
        CHECK(jacobians[block][3 * i + k] == doctest::Approx(numeric).epsilon(1e-6));
      }
    }
  }
}

TEST_CASE("a known motion is found by full steps, not by small fractions of one") {
  const Pose T = pose_from_xyz_rpy({0.8, -0.3, 0.1}, 0.02, -0.03, 0.15);
  const auto constraints = constraints_of(T, 300, 2);
  const Pose found = pose_of(align(constraints, MotionParameters::Zero(), FreeParameters::kAll, 6));
  CHECK((found.translation() - T.translation()).norm() < 1e-5);
  CHECK(rotation_angle_rad(found.inverse() * T) < 1e-6);
}

TEST_CASE("held parameters keep their values, free ones are found") {
  const MotionParameters truth = some_parameters();
  const auto constraints = constraints_of(pose_of(truth), 300, 3);
  MotionParameters start = truth;
  start[3] += 0.2;
  start[4] += 0.05;
  const auto found = align(constraints, start, FreeParameters::kOutOfPlane, 8);
  CHECK(found.head<3>() == start.head<3>());
  CHECK(found.tail<3>().isApprox(truth.tail<3>(), 1e-4));
}

TEST_CASE("the motion along a corridor is unobservable and held") {
  // Walls left and right, a floor: normals along y and z only.
  std::vector<PlaneConstraint> corridor;
  std::mt19937 generator(4);
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector3d p(10 * random_unit(generator), i % 3 == 0 ? -3.0 : 3.0,
                            random_unit(generator));
    corridor.push_back({p, Eigen::Vector3d::UnitY(), p.y() + 0.1, 1.0});
    const Eigen::Vector3d floor(10 * random_unit(generator), 3 * random_unit(generator), -1.7);
    corridor.push_back({floor, Eigen::Vector3d::UnitZ(), floor.z() + 0.05, 1.0});
  }
  const auto observable = observability(corridor, FreeParameters::kAll);
  CHECK(observable.degenerate_directions == 1);
  const MotionParameters end = (MotionParameters() << 5.0, 0.1, 0.01, 0.05, 0.0, 0.0).finished();
  const auto kept = without_unobservable(MotionParameters::Zero(), end, observable);
  CHECK(std::abs(kept[0]) < 0.05);
  CHECK(kept[1] == doctest::Approx(0.1).epsilon(0.02));
  CHECK(kept[3] == doctest::Approx(0.05).epsilon(0.02));
}

TEST_CASE("the degeneracy test does not depend on the number of points") {
  const auto few = constraints_of(Pose::Identity(), 60, 5);
  auto many = few;
  for (int i = 0; i < 20; ++i) many.insert(many.end(), few.begin(), few.end());
  CHECK(observability(few, FreeParameters::kAll)
            .share.isApprox(observability(many, FreeParameters::kAll).share, 1e-9));
}

TEST_CASE("held parameters are never called degenerate") {
  std::vector<PlaneConstraint> floor;
  std::mt19937 generator(6);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d p(10 * random_unit(generator), 10 * random_unit(generator), -1.7);
    floor.push_back({p, Eigen::Vector3d::UnitZ(), -1.7, 1.0});
  }
  CHECK(observability(floor, FreeParameters::kOutOfPlane).degenerate_directions == 0);
  CHECK(observability(floor, FreeParameters::kAll).degenerate_directions == 3);
}

TEST_CASE("an edge feature's two planes measure the distance from its line") {
  const Eigen::Vector3d on_line(1, 2, 3);
  const Eigen::Vector3d direction = Eigen::Vector3d(1, 1, 2).normalized();
  const Eigen::Vector3d point = on_line + 5.0 * direction + 0.3 * direction.unitOrthogonal();
  double squared_m2 = 0.0;
  for (const auto& plane : edge_constraints(point, on_line, direction, 1.0)) {
    CHECK(std::abs(plane.normal.dot(direction)) < 1e-12);
    squared_m2 += std::pow(plane.normal.dot(point) - plane.offset_m, 2);
  }
  CHECK(std::sqrt(squared_m2) == doctest::Approx(0.3));
}

#include "imu/inertial_check.h"

#include "testing.h"

namespace hqslam::slam {
namespace {

using Eigen::Vector3d;

/// The rate of a sensor that nods and sways while it turns to and fro.
Vector3d true_rate(int scan) {
  return {0.1 * std::sin(0.7 * scan), 0.15 * std::cos(0.4 * scan), 0.5 * std::sin(0.2 * scan)};
}

/// The check after scans whose turns were measured so.
InertialCheck check_of(const auto& measured, int scans = 120) {
  InertialCheck check;
  for (int scan = 0; scan < scans; ++scan) {
    check.compare_turns({0.1 * scan, measured(scan), true_rate(scan)});
  }
  return check;
}

/// The check after four seconds of the gentle turns of a street, registered with an error.
InertialCheck check_on_street(double factor, double late_s, int scans = 45) {
  const auto turns = [](double scan) -> Vector3d {
    return {0.003 * std::sin(0.6 * scan), 0.004 * std::cos(0.5 * scan),
            0.02 * std::sin(0.1 * scan)};
  };
  InertialCheck check;
  for (int scan = 0; scan < scans; ++scan) {
    const Vector3d error = 0.001 * Vector3d(std::sin(3.0 * scan), std::cos(4.0 * scan), 1.0);
    check.compare_turns({0.1 * scan, factor * turns(scan - 10.0 * late_s), turns(scan) + error});
  }
  return check;
}

bool holds(const InertialCheck& check, const std::string& part) {
  return check.complaint().find(part) != std::string::npos;
}

bool refuted(const InertialCheck& check, const std::string& part) {
  return !check.agrees() && holds(check, part);
}

}  // namespace

TEST_CASE("a gyroscope that measures the registered turns and a bias agrees") {
  const InertialCheck check =
      check_of([](int scan) -> Vector3d { return true_rate(scan) + Vector3d(0.01, -0.02, 0.03); });
  CHECK(check.agrees());
  CHECK(check.complaint().empty());
}

TEST_CASE("a gyroscope in degrees, with other axes, stuck or late is refuted and explained") {
  const auto degrees = [](int scan) -> Vector3d { return 57.29578 * true_rate(scan); };
  CHECK(refuted(check_of(degrees), "57-fold; degrees per second?"));
  const auto axes = [](int scan) -> Vector3d {
    const Vector3d rate = true_rate(scan);
    return {rate.y(), -rate.x(), -rate.z()};
  };
  CHECK(refuted(check_of(axes), "axes -y, x, -z?"));
  const auto stuck = [](int) -> Vector3d { return Vector3d::Zero(); };
  CHECK(refuted(check_of(stuck), "no turns where the scans turn"));
  const auto late = [](int scan) { return true_rate(scan - 8); };
  CHECK(refuted(check_of(late), "another clock?"));
}

TEST_CASE("a sensor that was refuted is taken again once its turns agree") {
  InertialCheck check;
  const auto compare = [&](int scan, const Vector3d& measured) {
    check.compare_turns({0.1 * scan, measured, true_rate(scan)});
  };
  for (int scan = 0; scan < 60; ++scan) compare(scan, Vector3d::Zero());
  REQUIRE_FALSE(check.agrees());
  for (int scan = 60; scan < 140; ++scan) compare(scan, true_rate(scan));
  CHECK(check.agrees());
  CHECK(check.is_proven());
}

TEST_CASE("gentle turns prove a right sensor, neither a stuck one nor one with negated rates") {
  CHECK_FALSE(InertialCheck().is_proven());
  CHECK(check_on_street(1.0, 0.0).is_proven());
  CHECK_FALSE(check_on_street(0.0, 0.0).is_proven());
  CHECK_FALSE(check_on_street(-1.0, 0.0).is_proven());
}

TEST_CASE("the turns that prove a sensor give its bias, once, over the time that they took") {
  const Vector3d bias(0.01, -0.02, 0.015);
  InertialCheck check;
  int given = 0;
  for (int scan = 0; scan < 120; ++scan) {
    const auto found = check.compare_turns({0.1 * scan, true_rate(scan) + bias, true_rate(scan)});
    if (!found) continue;
    ++given;
    CHECK((found->rad_per_s - bias).norm() < 1e-9);
    CHECK(found->duration_s == doctest::Approx(0.1 * scan));
  }
  CHECK(given == 1);
}

TEST_CASE("a clock that is 0.06 or 0.2 s late proves nothing and is refuted with its lateness") {
  CHECK_FALSE(check_on_street(1.0, 0.06).is_proven());
  CHECK_FALSE(check_on_street(1.0, -0.06).is_proven());
  CHECK(refuted(check_on_street(1.0, 0.06, 120), "its clock is 0.06 s late"));
  CHECK_FALSE(check_on_street(1.0, 0.2, 120).agrees());
}

TEST_CASE("scans that fit clearly better with a sensor prove it: a hand turns at once") {
  InertialCheck check;
  for (int scan = 0; scan < 4; ++scan) check.add_gain();
  CHECK_FALSE(check.is_proven());
  check.add_gain();
  CHECK(check.is_proven());
}

TEST_CASE("without turns nothing is decided: a standing sensor cannot refute a stuck one") {
  InertialCheck check;
  const Vector3d noise(0.004, -0.003, 0.005);
  for (int scan = 0; scan < 100; ++scan) {
    check.compare_turns({0.1 * scan, Vector3d::Zero(), scan % 2 == 0 ? noise : Vector3d(-noise)});
  }
  CHECK(check.agrees());
  CHECK_FALSE(check.is_proven());
}

TEST_CASE("single samples that are wrong refute nothing, lasting innovations do") {
  InertialCheck check = check_of([](int scan) -> Vector3d {
    return scan % 40 == 20 ? Vector3d(0.0, 0.0, 35.0) : true_rate(scan);
  });
  for (int scan = 0; scan < 100; ++scan) check.add_innovation(scan % 40 < 3 ? 1e6 : 0.1);
  CHECK(check.agrees());
  for (int scan = 0; scan < 30; ++scan) check.add_innovation(2.0);
  CHECK_FALSE(check.agrees());
  CHECK_FALSE(check.complaint().empty());
}

TEST_CASE("gravity has to be 9.8 m/s^2 and to point upwards as a force") {
  InertialCheck check;
  CHECK(is_gravity({1.0, -2.0, 9.5}));
  for (const auto& [force_mps2, part] : {std::pair(Vector3d(0, 0, -9.8), "point downwards"),
                                         {Vector3d(9.8, 0, 0.5), "point sideways"},
                                         {Vector3d(0, 0, 1), "in g?"}}) {
    CHECK_FALSE(is_gravity(force_mps2));
    check.complain_about_force(force_mps2);
    CHECK(holds(check, part));
  }
}

}  // namespace hqslam::slam

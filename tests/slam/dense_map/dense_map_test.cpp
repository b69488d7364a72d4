#include "hqslam/slam/dense_map.h"

#include "slam/cloud_of.h"
#include "slam/random_unit.h"
#include "thread_limit.h"

using namespace hqslam::slam;
using hqslam::test::refused_with;

namespace {

/// The cloud if all of it were computed.
OrganizedCloud computed(OrganizedCloud cloud, float confidence) {
  cloud.confidence.assign(cloud.range_m.size(), confidence);
  return cloud;
}

/// An upright wall `x_m` ahead, 2 m wide and 1 m high, in steps of 5 cm.
std::vector<Eigen::Vector3f> wall(float x_m) {
  std::vector<Eigen::Vector3f> points_m;
  for (int i = 0; i < 40; ++i) {
    for (int k = 0; k < 20; ++k) {
      points_m.emplace_back(x_m, -0.975F + 0.05F * static_cast<float>(i),
                            -0.475F + 0.05F * static_cast<float>(k));
    }
  }
  return points_m;
}

const SensorPath kOrigin{Pose::Identity()};

SensorPath at(double x_m, double y_m = 0.0) {
  return SensorPath(Pose(Eigen::Translation3d(x_m, y_m, 0.0)));
}

void insert(DenseMap& map, const OrganizedCloud& cloud) {
  map.insert(cloud, std::nullopt, kOrigin);
}

std::size_t points_near_x(const std::vector<DenseMapPoint>& points, float x_m) {
  return static_cast<std::size_t>(std::ranges::count_if(
      points, [&](const auto& p) { return std::abs(p.point_m.x() - x_m) < 0.06F; }));
}

template <typename Value>
bool same_bytes(const std::vector<Value>& a, const std::vector<Value>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Value)) == 0;
}

/// Scans of a random scatter about the sensor, measured and computed, from places along a line.
std::vector<OrganizedCloud> random_scans(int count) {
  std::mt19937 generator(11);
  const auto random = [&] { return static_cast<float>(random_unit(generator)); };
  std::vector<OrganizedCloud> scans;
  for (int scan = 0; scan < count; ++scan) {
    OrganizedCloud cloud(4, 500);
    for (std::size_t i = 0; i < cloud.range_m.size(); ++i) {
      cloud.points_m[i] = {3.0F * random(), 3.0F * random(), random()};
      cloud.range_m[i] = cloud.points_m[i].norm();
      cloud.confidence.push_back(i % 4 == 0 ? 1.0F : 0.5F + 0.5F * random());
      cloud.time_offset_s.push_back(0.05F * random());
      if (scan % 3 != 0) cloud.intensity.push_back(100.0F + 100.0F * random());
    }
    scans.push_back(cloud);
  }
  return scans;
}

std::vector<DenseMapPoint> map_of(const std::vector<OrganizedCloud>& scans, bool backwards,
                                  int threads, std::vector<float>& intensity) {
  const ThreadLimit limit(threads);
  Trajectory trajectory;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const double k = static_cast<double>(i);
    trajectory.push_back({0.1 * k, pose_from_xyz_rpy({0.5 * k, 0.0, 0.0}, 0.0, 0.0, 0.1 * k)});
  }
  std::vector<std::size_t> order(scans.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = backwards ? order.size() - 1 - i : i;
  DenseMap map({});
  for (const std::size_t i : order) map.insert(scans[i], std::nullopt, SensorPath(trajectory, i));
  for (const std::size_t i : order) map.see_through(scans[i], SensorPath(trajectory, i));
  return map.points(&intensity);
}

}  // namespace

TEST_CASE("one point per voxel: the mean of the measured ones, in the map's frame") {
  DenseMap map({});
  map.insert(cloud_of({{1.02F, 0.05F, 0.05F}, {1.06F, 0.05F, 0.05F}, {1.15F, 0.05F, 0.05F}}),
             std::nullopt, at(10.0));
  const auto points = map.points();
  REQUIRE(points.size() == 2);
  CHECK(map.voxels() == 2);
  CHECK((points[0].point_m - Eigen::Vector3f(11.04F, 0.05F, 0.05F)).norm() < 1e-3F);
  CHECK((points[1].point_m - Eigen::Vector3f(11.15F, 0.05F, 0.05F)).norm() < 1e-3F);
  CHECK(points[0].times_seen == 1);
}

TEST_CASE("a voxel's intensity is the mean of those of the points that its place is the mean of") {
  const float nan = std::nanf("");
  OrganizedCloud measured = cloud_of({{1.02F, 0.05F, 0.05F}, {1.06F, 0.05F, 0.05F}});
  measured.intensity = {0.25F, 100.0F};
  OrganizedCloud guesses = computed(
      cloud_of({{1.05F, 0.05F, 0.05F}, {1.15F, 0.05F, 0.05F}, {1.16F, 0.05F, 0.05F}}), 0.5F);
  guesses.intensity = {7.0F, 20.0F, 40.0F};
  guesses.confidence[2] = 0.98F;
  OrganizedCloud silent = cloud_of({{1.25F, 0.05F, 0.05F}, {1.35F, 0.05F, 0.05F}});
  OrganizedCloud unknown = silent;
  unknown.intensity = {nan, 8.0F};
  const std::vector<OrganizedCloud> scans = {measured, guesses, silent, unknown};
  std::vector<std::size_t> order = {0, 1, 2, 3};
  do {
    DenseMap map({.least_confidence = 0.01});
    for (const std::size_t i : order) insert(map, scans[i]);
    std::vector<float> intensity;
    REQUIRE(map.points(&intensity).size() == 4);
    REQUIRE(intensity.size() == 4);
    CHECK(intensity[0] == 50.125F);  // the computed point does not count
    CHECK(intensity[1] == doctest::Approx((8 * 20.0 + 16 * 40.0) / 24).epsilon(1e-5));
    CHECK(std::isnan(intensity[2]));
    CHECK(intensity[3] == 8.0F);
  } while (std::next_permutation(order.begin(), order.end()));
  DenseMap without({});
  insert(without, cloud_of(wall(5.0F)));
  std::vector<float> intensity = {1.0F};
  CHECK(without.points(&intensity).size() == 200);
  CHECK(intensity.empty());
}

TEST_CASE("points of a turning, driving sensor are placed by its pose at their capture times") {
  Trajectory trajectory;
  for (int i = 0; i < 3; ++i) {
    trajectory.push_back({0.1 * i, pose_from_xyz_rpy({1.0 * i, 0.0, 0.0}, 0.0, 0.0, 0.2 * i)});
  }
  // One object, measured early and late in the scan.
  const Eigen::Vector3d thing_m(4.05, 3.05, 0.05);
  std::vector<Eigen::Vector3f> seen_m;
  const SensorPath path(trajectory, 1);
  for (const double t : {-0.05, 0.05}) {
    seen_m.push_back((path.at(t).inverse() * thing_m).cast<float>());
  }
  OrganizedCloud cloud = cloud_of(seen_m);
  cloud.time_offset_s = {-0.05F, 0.05F};
  DenseMap map({});
  map.insert(cloud, std::nullopt, path);
  const auto points = map.points();
  REQUIRE(points.size() == 1);
  CHECK((points[0].point_m.cast<double>() - thing_m).norm() < 2e-3);
}

TEST_CASE("a wall that beams of other scans cross vanishes; one that they meet stays") {
  DenseMap map({});
  // Something stands 5 m ahead in two scans and is gone in six.
  for (int i = 0; i < 2; ++i) insert(map, cloud_of(wall(5.05F)));
  for (int i = 0; i < 6; ++i) insert(map, cloud_of(wall(10.05F)));
  CHECK(points_near_x(map.points(), 5.05F) == 200);
  for (int i = 0; i < 2; ++i) map.see_through(cloud_of(wall(5.05F)), kOrigin);
  // The far wall fills half of the near one's angle; a dense one crosses every voxel.
  for (int i = 0; i < 6; ++i) {
    std::vector<Eigen::Vector3f> dense_m;
    for (const Eigen::Vector3f& point_m : wall(5.05F)) dense_m.push_back(10.05F / 5.05F * point_m);
    map.see_through(cloud_of(dense_m), kOrigin);
  }
  CHECK(points_near_x(map.points(), 5.05F) == 0);
  CHECK(points_near_x(map.points(), 10.05F) == 200);
}

TEST_CASE("a computed wall is in the map when scans agree, a lone computed point is not") {
  const OrganizedCloud lone = computed(cloud_of({{5.05F, 0.05F, 0.05F}}), 0.5F);
  DenseMap map({});
  insert(map, lone);
  CHECK(map.points().empty());
  insert(map, lone);
  REQUIRE(map.points().size() == 1);
  CHECK(map.points()[0].confidence == doctest::Approx(0.5).epsilon(1e-3));
  CHECK(map.points()[0].times_seen == 2);
}

TEST_CASE("a computed point between measured ones needs less confidence than one in the open") {
  DenseMap map({});
  insert(map, cloud_of({{5.05F, -0.05F, 0.05F}, {5.05F, 0.15F, 0.05F}}));
  insert(map, computed(cloud_of({{5.05F, 0.05F, 0.05F}, {5.05F, 2.05F, 0.05F}}), 0.5F));
  CHECK(map.points().size() == 3);
}

TEST_CASE("rows between the measured ones are computed, with the assumed confidence by default") {
  OrganizedCloud cloud(2, 1);
  cloud.points_m = {{5.05F, 0.05F, 0.05F}, {5.05F, 0.05F, 1.05F}};
  cloud.range_m = {5.05F, 5.16F};
  DenseMap map({});
  map.insert(cloud, RowSelection{1, 2}, kOrigin);
  REQUIRE(map.points().size() == 1);
  CHECK(map.points()[0].point_m.z() > 1.0F);
  DenseMap other({.assumed_confidence = 0.9});
  other.insert(cloud, RowSelection{1, 2}, kOrigin);
  CHECK(other.points().size() == 2);
}

TEST_CASE("the same scans give the same bytes, in any order, with one thread and with three") {
  const auto scans = random_scans(8);
  std::vector<float> bright;
  const auto one = map_of(scans, false, 1, bright);
  CHECK(one.size() > 500);
  CHECK(bright.size() == one.size());
  for (const auto& [backwards, threads] : {std::pair{true, 1}, {false, 3}}) {
    std::vector<float> also_bright;
    CHECK(same_bytes(one, map_of(scans, backwards, threads, also_bright)));
    CHECK(same_bytes(bright, also_bright));
  }
}

TEST_CASE("memory is bounded: a full map adds no voxels and reports it") {
  DenseMap map({.max_voxels = 100});
  insert(map, cloud_of(wall(5.05F)));
  CHECK(map.is_full());
  CHECK(map.voxels() == 100);
  insert(map, cloud_of(wall(5.05F)));
  CHECK(map.voxels() == 100);
  const auto points = map.points();
  REQUIRE(points.size() == 100);
  CHECK(std::ranges::all_of(points, [](const auto& p) { return p.times_seen == 2; }));
}

TEST_CASE("points beyond the range, without a return or not finite leave no trace") {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinite = std::numeric_limits<float>::infinity();
  OrganizedCloud cloud =
      cloud_of({{60.0F, 0.0F, 0.0F}, {5.0F, 0.0F, 0.0F}, {kNan, 0.0F, 0.0F}, {1e30F, 0.0F, 0.0F}});
  cloud.range_m = {60.0F, 0.0F, 5.0F, 5.0F};
  DenseMap map({});
  insert(map, cloud);
  map.see_through(cloud, kOrigin);
  cloud.range_m = {kNan, kInfinite, -5.0F, kInfinite};
  insert(map, cloud);
  cloud.range_m.assign(4, 5.0F);
  cloud.time_offset_s.assign(4, kNan);
  insert(map, cloud);
  map.see_through(cloud, kOrigin);
  CHECK(map.voxels() == 0);
  CHECK(map.points().empty());
}

TEST_CASE("clouds, poses and options that cannot be are errors of one line") {
  DenseMap map({});
  OrganizedCloud cloud = cloud_of({{5.0F, 0.0F, 0.0F}, {6.0F, 0.0F, 0.0F}});
  cloud.confidence = {1.0F};
  CHECK(refused_with([&] { insert(map, cloud); }, "1x2", "1 confidences"));
  cloud.confidence.clear();
  cloud.intensity = {1.0F, 2.0F, 3.0F};
  CHECK(refused_with([&] { insert(map, cloud); }, "1x2", "3 intensities"));
  cloud.intensity.clear();
  cloud.range_m.pop_back();
  CHECK(refused_with([&] { map.see_through(cloud, kOrigin); }, "1 ranges"));
  cloud = cloud_of({{5.0F, 0.0F, 0.0F}});
  CHECK(refused_with([&] { map.insert(cloud, {}, at(HUGE_VAL)); }, "expected a finite pose"));
  CHECK(refused_with([] { DenseMap({.voxel_m = 0.0}); }, "voxel_m", "0.02"));
  CHECK(refused_with([] { validate(DenseMapOptions{.least_confidence = 1.0}); }, "least_confidence",
                     "0.999"));
  CHECK(refused_with([] { validate(DenseMapOptions{.max_range_m = NAN}); }, "max_range_m"));
}

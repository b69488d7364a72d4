#include "pages/turning_view.h"

#include <nlohmann/json.hpp>

#include "tools/parts_of_text.h"

namespace hqslam::tools {
namespace {

std::vector<Eigen::Vector3f> points_m(std::size_t count) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> along_m(-100.0F, 100.0F);
  std::vector<Eigen::Vector3f> result;
  for (std::size_t i = 0; i < count; ++i) {
    result.emplace_back(along_m(random), along_m(random), 0.05F * along_m(random));
  }
  return result;
}

/// Points are 4 bytes each, as base64.
std::size_t points_in(const nlohmann::json& cloud) {
  return cloud["points"].get<std::string>().size() * 3 / 16;
}

}  // namespace

TEST_CASE("a view has all points of a small cloud, and no more than a page may have") {
  TurningView view;
  view.clouds = {{"large", points_m(kMostCloudPoints + 100'000)}, {"small", points_m(1000)}};
  view.last_scan = {"scan", Pose::Identity(), {"", points_m(50'000)}};
  const nlohmann::json data = turning_view_json(view);
  CHECK(points_in(data["clouds"][1]) >= 999);
  CHECK(points_in(data["clouds"][0]) <= kMostCloudPoints - 1000);
  CHECK(points_in(data["clouds"][0]) > kMostCloudPoints * 9 / 10);
  CHECK(points_in(data["scans"][0]["measured"]) > 49'000);
  CHECK(data.dump().size() < 7'000'000);
}

TEST_CASE("intensities go from their 2nd to their 98th percentile, a byte for each point") {
  ViewCloud cloud{"map", points_m(101)};
  for (int i = 0; i <= 100; ++i) cloud.intensity.push_back(static_cast<float>(i));
  const nlohmann::json map = turning_view_json({{cloud}, {}, {}})["clouds"][0];
  CHECK(map["bright"] == nlohmann::json({2.0, 98.0}));
  CHECK(map["brightness"].get<std::string>().size() == 136);  // 101 bytes as base64
  cloud.intensity.assign(101, std::nanf(""));
  CHECK(turning_view_json({{cloud}, {}, {}})["clouds"][0]["bright"].empty());
}

TEST_CASE("a view of nothing is still valid, with finite numbers alone") {
  const nlohmann::json data = turning_view_json({});
  CHECK(data["clouds"].empty());
  CHECK(data["scans"].empty());
  CHECK(data["radius"] == 5.0);
  CHECK_FALSE(holds(data.dump(), "null"));
}

TEST_CASE("the view begins around the path, or around most of the points") {
  TurningView view;
  view.clouds = {{"map", points_m(1000)}};
  CHECK(turning_view_json(view)["radius"].get<double>() == doctest::Approx(127).epsilon(0.05));
  view.paths = {{"path", {{{100.0F, 0.0F, 1.0F}, {130.0F, 0.0F, 1.0F}}}}};
  const nlohmann::json data = turning_view_json(view);
  CHECK(data["centre"] == nlohmann::json({115.0, 0.0, 1.0}));
  CHECK(data["radius"].get<double>() == doctest::Approx(33.5).epsilon(0.01));
}

TEST_CASE("a large occupancy grid is thinned: a cell is occupied if one of its own is") {
  using enum slam::Occupancy;
  const slam::OccupancyMap map{
      0.1, {1.0, 2.0}, 2, 3, {kUnknown, kFree, kOccupied, kOccupied, kUnknown, kFree}};
  const slam::OccupancyMap coarse = thinned(map, 2);
  CHECK(coarse.rows == 1);
  CHECK(coarse.columns == 2);
  CHECK(coarse.resolution_m == doctest::Approx(0.2));
  CHECK(coarse.origin_m == map.origin_m);
  CHECK(coarse.cells == std::vector{kOccupied, kOccupied});
  CHECK(thinned(map, 6).cells == map.cells);
}

TEST_CASE("a view of a grid alone begins over the grid, one of paths has their names in order") {
  TurningView view;
  view.grid = {{0.5, {10.0, -20.0}, 40, 20, std::vector(800, slam::Occupancy::kFree)}, "summary"};
  const nlohmann::json grid = turning_view_json(view);
  CHECK(grid["centre"] == nlohmann::json({15.0, -10.0, 0.0}));
  CHECK(grid["grid"]["summary"] == "summary");
  view.paths = {{"first", {{{1.0F, 2.0F, 3.0F}}}}, {"second"}};
  CHECK(turning_view_json(view)["paths"].dump() ==
        R"([{"name":"first","pieces":[[[1.0,2.0,3.0]]]},{"name":"second","pieces":[]}])");
}

}  // namespace hqslam::tools

#include "run/slam_settings.h"

#include "testing.h"

using namespace hqslam::tools;

namespace {

/// The options that a file with this text and these --set give.
slam::SlamOptions options_of(const std::string& json, std::vector<std::string> set = {}) {
  return from_file("slam.json", json, [&](const auto& path) {
    return slam_options({"hqslam", path, std::move(set), false});
  });
}

}  // namespace

TEST_CASE("a file sets options of SLAM by stage and name, and --set comes after it") {
  const auto options =
      options_of(R"({"mapping": {"max_iterations": 12, "planar_leaf_m": 0.5}, "features": {}})",
                 {"mapping.planar_leaf_m=0.3", "mapping.min_correspondences=7"});
  CHECK(options.mapping.max_iterations == 12);
  CHECK(options.mapping.planar_leaf_m == 0.3);
  CHECK(options.mapping.min_correspondences == 7);
  const std::vector<std::pair<std::string, double>> changed = {{"mapping.max_iterations", 12.0},
                                                               {"mapping.min_correspondences", 7.0},
                                                               {"mapping.planar_leaf_m", 0.3}};
  CHECK(changed_options(options) == changed);
  CHECK(changed_options(slam_options({})).empty());
  CHECK(slam_options({}).loop_closing.enabled);
  CHECK_FALSE(slam_options({"hqslam", "", {}, false}).loop_closing.enabled);
}

TEST_CASE("settings of SLAM that cannot be meant are refused with their name or how to make them") {
  const std::vector<std::tuple<const char*, std::vector<std::string>, const char*>> cases = {
      {"[1]", {}, "expected a JSON object"},
      {"[1]", {}, "hqslam slam-options --json >options.json makes"},
      {"{", {}, "expected a JSON object"},
      {R"({"mapping": 3})", {}, "expected an object in \"mapping\""},
      {R"({"mapping": {"max_iterations": "12"}})", {}, "a number in mapping.max_iterations"},
      {R"({"mapping": {"max_iterations": 2.5}})", {}, "expected a whole number"},
      {R"({"mapping": {"no_such": 1}})", {}, "a SLAM option, found mapping.no_such"},
      {"{}", {"mapping.max_iterations"}, "expected NAME=NUMBER"},
      {"{}", {"mapping.max_iterations=12x"}, "expected NAME=NUMBER"},
      {"{}", {"=1"}, "a SLAM option"},
      {"{}", {"ground.max_slope_rad=2"}, "an angle between 0 and pi/2"},
      {"{}", {"mapping.close_neighbour_distance_m=3"}, "at most mapping.max_neighbour_distance_m"},
  };
  for (const auto& [json, set, expected] : cases) {
    CAPTURE(expected);
    CHECK_THROWS_WITH_AS(options_of(json, set), doctest::Contains(expected), Error);
  }
}

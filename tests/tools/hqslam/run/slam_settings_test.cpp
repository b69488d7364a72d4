#include "run/slam_settings.h"

#include "testing.h"

using namespace hqslam::tools;

TEST_CASE("--set sets options of SLAM by stage and name, the last one of a name counts") {
  const slam::SlamOptions options =
      slam_options({.set = {"mapping.max_iterations=12", "mapping.planar_leaf_m=0.5",
                            "mapping.planar_leaf_m=0.3"},
                    .loop_closing = false});
  CHECK(options.mapping.max_iterations == 12);
  CHECK(options.mapping.planar_leaf_m == 0.3);
  CHECK_FALSE(options.loop_closing.enabled);
  const std::vector<std::pair<std::string, double>> changed = {{"mapping.max_iterations", 12.0},
                                                               {"mapping.planar_leaf_m", 0.3}};
  CHECK(changed_options(options) == changed);
  CHECK(changed_options(slam_options({})).empty());
  CHECK(slam_options({}).loop_closing.enabled);
}

TEST_CASE("settings of SLAM that cannot be meant are refused with their name") {
  const std::pair<const char*, const char*> cases[] = {
      {"mapping.max_iterations", "expected NAME=NUMBER"},
      {"mapping.max_iterations=12x", "expected NAME=NUMBER"},
      {"mapping.max_iterations=2.5", "expected a whole number"},
      {"mapping.no_such=1", "a SLAM option, found mapping.no_such"},
      {"=1", "a SLAM option"},
      {"mapping.planar_leaf_m=0.09", "0.1 or more"},
  };
  for (const auto& [set, expected] : cases) {
    CAPTURE(set);
    CHECK_THROWS_WITH_AS(slam_options({.set = {set}}), doctest::Contains(expected), Error);
  }
}

#include "hqslam/slam/saved_map.h"

#include "hqslam/core/npz.h"
#include "testing.h"

namespace {

slam::SavedMap small_saved_map() {
  slam::SavedMap map;
  map.edges_m = {{1.0F, 2.0F, 3.0F}, {-4.0F, 5.5F, 0.25F}};
  map.planes_m = {{7.0F, 8.0F, 9.0F}};
  for (const double x_m : {0.0, 4.0}) {
    slam::SavedPlace place;
    place.T_map_sensor = pose_from_xyz_rpy({x_m, 1.0, 2.0}, 0.1, -0.2, 3.0);
    place.context.unit_sectors.setZero();
    place.context.unit_sectors(3, 17) = 1.0F;
    place.context.has_returns[17] = true;
    map.places.push_back(place);
  }
  return map;
}

}  // namespace

TEST_CASE("a saved map is read back unchanged, with intensities or of before them") {
  const TemporaryDirectory folder;
  slam::SavedMap map = small_saved_map();
  slam::write_saved_map(folder.file("map.npz"), map);
  CHECK_FALSE(read_npz(folder.file("map.npz")).contains("edges_intensity"));
  CHECK(slam::read_saved_map(folder.file("map.npz")).edges_intensity.empty());
  CHECK(slam::read_saved_map(folder.file("map.npz")).close_ratio == 0.0);
  map.close_ratio = 0.4;
  map.edges_intensity = {12.0F, std::numeric_limits<float>::quiet_NaN()};
  slam::write_saved_map(folder.file("map.npz"), map);
  const slam::SavedMap read = slam::read_saved_map(folder.file("map.npz"));
  CHECK(read.close_ratio == map.close_ratio);
  CHECK(read.edges_m == map.edges_m);
  CHECK(read.posts_m.empty());
  CHECK(read.planes_m == map.planes_m);
  REQUIRE(read.edges_intensity.size() == 2);
  CHECK(read.edges_intensity[0] == 12.0F);
  CHECK(std::isnan(read.edges_intensity[1]));
  CHECK(read.planes_intensity.empty());
  REQUIRE(read.places.size() == map.places.size());
  for (std::size_t i = 0; i < map.places.size(); ++i) {
    CHECK(read.places[i].T_map_sensor.matrix() == map.places[i].T_map_sensor.matrix());
    CHECK(read.places[i].context.unit_sectors == map.places[i].context.unit_sectors);
    CHECK(read.places[i].context.has_returns == map.places[i].context.has_returns);
  }
}

TEST_CASE("a file that is no saved map is refused in one line") {
  using Floats = std::vector<float>;
  using Doubles = std::vector<double>;
  const std::vector<std::tuple<const char*, std::optional<NpzArray>, const char*>> cases = {
      {"format", {}, "expected a map saved by"},
      {"format", npz_text("hqslam map 2"), "expected a map saved by"},
      {"posts_m", {}, "expected an array posts_m, found none"},
      {"edges_m", npz_array(Floats(6), {3, 2}), "edges_m: expected rows of 3, found another shape"},
      {"edges_m", npz_array(Doubles(6), {2, 3}), "edges_m"},
      {"planes_m", npz_array(Floats{0, std::nanf(""), 0}, {1, 3}),
       "planes_m: expected finite numbers, found nan"},
      {"posts_m", npz_array(Floats{0, 0, -1e10F}, {1, 3}),
       "posts_m: expected coordinates up to 1000000 m, found -10000000000 m"},
      {"edges_intensity", npz_array(Floats(3), {3}),
       "edges_intensity: expected one number for each of 2 points, found 3"},
      {"close_ratio", npz_array(Doubles{2}, {1}), "close_ratio: expected a share of 1, found 2"},
      {"T_map_place", npz_array(Doubles{1, 0, 0, 1e10, 0, 1, 0, 0, 0, 0, 1, 0}, {1, 3, 4}),
       "T_map_place: expected coordinates"},
      {"T_map_place", npz_array(Doubles(24), {2, 3, 4}), "expected rotations"},
      {"T_map_place", npz_array(Doubles(12), {1, 3, 4}), "a context for each of 1 places, found 2"},
  };
  const TemporaryDirectory folder;
  const std::string path = folder.file("map.npz");
  slam::write_saved_map(path, small_saved_map());
  const NpzArrays saved = read_npz(path);
  for (const auto& [array, instead, expected] : cases) {
    CAPTURE(expected);
    NpzArrays arrays = saved;
    arrays.erase(array);
    if (instead) arrays[array] = *instead;
    write_npz(path, arrays);
    CHECK_THROWS_WITH_AS(slam::read_saved_map(path), doctest::Contains(expected), Error);
  }
  CHECK_THROWS_WITH_AS(slam::read_saved_map("dense_map.pcd"), doctest::Contains("--save-map"),
                       Error);
  CHECK_THROWS_AS(slam::read_saved_map("/no/such/file.npz"), Error);
}

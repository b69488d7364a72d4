#include "hqslam/slam/occupancy_grid.h"
#include "input_file.h"
#include "map/feature_maps.h"
#include "replaced_array.h"

namespace hqslam::fuzz {
namespace {

NpzArrays good_map() {
  slam::SavedMap map;
  for (int i = 0; i < 30; ++i) {
    const auto along = static_cast<float>(i);
    map.edges_m.emplace_back(along, 3.0F, 0.1F * along);
    map.posts_m.emplace_back(along, -3.0F, 0.2F * along);
    map.planes_m.emplace_back(along, 0.5F * along, -1.7F);
  }
  for (int i = 0; i < 2; ++i) {
    slam::SavedPlace place{pose_from_xyz_rpy({15.0 * i, 0.0, 0.0}, 0.0, 0.0, 0.1 * i), {}};
    place.context.unit_sectors.setConstant(0.2F);
    map.places.push_back(place);
  }
  const std::string path = as_file({}, ".npz");
  slam::write_saved_map(path, map);
  return read_npz(path);
}

}  // namespace

/// As a sensor is looked for in a map: about each of its places.
void saved_map(Bytes input) {
  static const NpzArrays good = good_map();
  const std::string path = as_file({}, ".npz");
  write_npz(path, with_one_replaced(good, input));
  const slam::SavedMap map = slam::read_saved_map(path);
  const slam::MappingOptions options;
  slam::FeatureMaps maps(options, map);
  for (const slam::SavedPlace& place : map.places) {
    const slam::Surroundings here{place.T_map_sensor.translation().cast<float>(), 50.0F};
    maps.about(options, here);
    maps.planes.nearest(here.centre_m);
    compare(place.context, map.places.front().context, 0.0, 3.2);
    maps.take_near(here);
  }
  maps.take_all();
}

void occupancy_map(Bytes input) {
  const std::string text(input.begin(), input.end());
  const std::size_t image = std::min(text.find("P5"), text.size());
  const std::string image_path = as_file(input.subspan(image), ".pgm");
  const std::string yaml = "image: " + image_path + '\n' + text.substr(0, image);
  static_cast<void>(slam::read_occupancy_map(
      as_file({reinterpret_cast<const std::uint8_t*>(yaml.data()), yaml.size()}, ".yaml")));
}

}  // namespace hqslam::fuzz

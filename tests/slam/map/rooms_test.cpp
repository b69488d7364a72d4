#include "map/rooms.h"

#include "testing.h"

namespace {

/// A hundred points, half of them nearer than this.
std::vector<slam::FeaturePoint> surfaces_at(float median_m) {
  std::vector<slam::FeaturePoint> surfaces(101);
  for (int i = 0; i <= 100; ++i) {
    surfaces[(7 * i) % 101].point_m.x() = median_m * (0.5F + 0.01F * static_cast<float>(i));
  }
  return surfaces;
}

}  // namespace

TEST_CASE("the first scan that has surfaces decides whether a map begins in a room") {
  slam::RoomCheck room;
  CHECK_FALSE(room.add({}));
  CHECK(room.add(surfaces_at(4.5F)));
  CHECK_FALSE(room.add({}));
  CHECK(room.is_in_room());
  slam::RoomCheck street;
  CHECK_FALSE(street.add(surfaces_at(6.0F)));
  CHECK_FALSE(street.is_in_room());
}

TEST_CASE("a gate is no room, and a hall between rooms no street") {
  slam::RoomCheck street;
  for (int i = 0; i < 20; ++i) CHECK_FALSE(street.add(surfaces_at(15.0F)));
  for (int i = 0; i < 8; ++i) CHECK_FALSE(street.add(surfaces_at(2.0F)));
  slam::RoomCheck room;
  room.add(surfaces_at(4.0F));
  for (int i = 0; i < 50; ++i) CHECK_FALSE(room.add(surfaces_at(6.5F)));
}

TEST_CASE("who goes out is in no room any more after two seconds, and back in it likewise") {
  slam::RoomCheck check;
  check.add(surfaces_at(4.0F));
  int changes = 0;
  for (int i = 0; i < 20; ++i) changes += check.add(surfaces_at(15.0F));
  CHECK(changes == 1);
  CHECK_FALSE(check.is_in_room());
  for (int i = 0; i < 30; ++i) changes += check.add(surfaces_at(4.0F));
  CHECK(changes == 2);
  CHECK(check.is_in_room());
}

TEST_CASE("in rooms voxels are half as large and planes flat to a quarter of the distance") {
  const slam::MappingOptions street;
  const slam::MappingOptions room = slam::in_rooms(street);
  CHECK(room.planar_leaf_m == 0.5 * street.planar_leaf_m);
  CHECK(room.located_planar_leaf_m == 0.5 * street.located_planar_leaf_m);
  CHECK(room.max_plane_residual_m == 0.25 * street.max_plane_residual_m);
  CHECK(room.max_iterations == street.max_iterations);
}

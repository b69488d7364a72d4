#include "front_end/segmentation.h"

#include "slam/yard.h"
#include "testing.h"

using namespace hqslam;
using slam::PixelClass;

TEST_CASE("every return of a yard is ground or an object and they add up") {
  const SensorModel sensor = test::small_sensor(32, 720);
  const OrganizedCloud cloud = test::Yard().scan(sensor, test::yard_pose(0, 0, 0));
  const auto result = slam::segment(cloud, sensor, {});
  int returns = 0;
  int ground = 0;
  for (const PixelClass pixel_class : result.pixel_class) {
    ground += pixel_class == PixelClass::kGround;
    returns += pixel_class != PixelClass::kNoReturn;
  }
  CHECK(result.returns == returns);
  CHECK(result.ground_points == ground);
  CHECK(ground > 0.2 * returns);
  CHECK(ground < 0.8 * returns);
}

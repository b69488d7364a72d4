#include <hqslam/recordings/recording.h>

#include <iostream>
#include <limits>

#include "driver_callback.h"

// Plays a driver: hands the points of a recording of an OS1-16 to the callback of docs/library.md.
int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const auto recording = hqslam::recordings::open_recording(argv[1]);
  DriverCallback callback{
      hqslam::nn::Upsampler(hqslam::nn::SuperResolver::load(argv[2], {.threads = 2}))};
  while (const auto scan = recording->next()) {
    const hqslam::OrganizedCloud& cloud = scan->cloud;
    std::vector<DriverPoint> turn;
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (int row = 0; row < cloud.rows; ++row) {
      for (int column = 0; column < cloud.columns; ++column) {
        const std::size_t pixel = cloud.index(row, column);
        const Eigen::Vector3f point_m =
            cloud.range_m[pixel] > 0 ? cloud.points_m[pixel] : Eigen::Vector3f(nan, nan, nan);
        turn.push_back({point_m.x(), point_m.y(), point_m.z(), cloud.rows - 1 - row,
                        scan->stamp_s + cloud.time_offset_s[pixel]});
      }
    }
    const double half_s = recording->sensor().scan_period_s / 2;
    const hqslam::Pose pose = callback(turn, scan->stamp_s - half_s, scan->stamp_s + half_s);
    std::cout << pose.translation().transpose() << '\n';
  }
}

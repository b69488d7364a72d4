#include <hqslam/core/scan_source.h>
#include <hqslam/slam/slam.h>

#include <iostream>

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const hqslam::SensorModel sensor = hqslam::load_sensor(argv[2]);
  const auto recording = hqslam::open_recording(argv[1], sensor);
  hqslam::slam::Slam slam(sensor);
  while (const auto scan = recording->next()) {
    const auto report = slam.process(scan->cloud, scan->stamp_s);
    std::cout << report.T_map_sensor.translation().transpose() << '\n';
  }
}

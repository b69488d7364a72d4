#include <hqslam/nn/upsampled_cloud.h>
#include <hqslam/recordings/recording.h>
#include <hqslam/slam/slam.h>

#include <iostream>

// A recording of an OS1-16 (a capture, a bag, ...) in, a pose per scan out, upsampled to 64 rows.
int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const auto recording = hqslam::recordings::open_recording(argv[1]);
  hqslam::nn::Upsampler upsampler(hqslam::nn::SuperResolver::load(argv[2]));
  hqslam::slam::Slam slam(upsampler.sensor());
  while (const auto scan = recording->next()) {
    const auto upsampled = hqslam::nn::upsampled_cloud(upsampler, scan->cloud);
    const auto report = slam.process(upsampled, scan->stamp_s);
    std::cout << report.T_map_sensor.translation().transpose() << '\n';
  }
}

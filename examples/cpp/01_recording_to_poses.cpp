#include <hqslam/pipeline/pipeline.h>
#include <hqslam/recordings/recording.h>

#include <iostream>

// A recording (a capture, a bag, ...) in, upsampled to 64 rows, a pose for each scan out.
int main(int argc, char** argv) {
  if (argc != 2) return 2;
  auto recording = hqslam::recordings::Recording::open(argv[1]);
  hqslam::pipeline::Pipeline pipeline(recording.sensor(), {.upsampling = {.method = "du-mix"}});
  while (const auto scan = recording.next()) {
    const auto located = pipeline.process(*scan);
    std::cout << located.report.T_map_sensor.translation().transpose() << '\n';
  }
}

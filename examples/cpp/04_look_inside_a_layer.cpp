#include <hqslam/nn/super_resolver.h>
#include <hqslam/nn/trace.h>
#include <hqslam/pipeline/upsampler.h>
#include <hqslam/recordings/recording.h>

#include <iostream>

// The tensors that a network makes of the first scan of a recording: name, shape and unit.
int main(int argc, char** argv) {
  if (argc != 3) return 2;
  auto recording = hqslam::recordings::Recording::open(argv[1]);
  const hqslam::pipeline::Upsampler upsampler(recording.sensor(), {.method = argv[2]});
  const auto scan = recording.next();
  if (!scan) return 1;
  auto network = hqslam::nn::SuperResolver::load(argv[2]);
  hqslam::nn::Trace trace;
  network.run(hqslam::range_image(upsampler.measured(scan->cloud)), &trace);
  for (const auto& tensor : trace.tensors()) {
    std::cout << tensor.name << "  " << tensor.channels() << " x " << tensor.rows() << " x "
              << tensor.columns() << "  " << tensor.unit << '\n';
  }
}

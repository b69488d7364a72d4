#include <hqslam/core/npy.h>
#include <hqslam/pipeline/upsampler.h>
#include <hqslam/recordings/recording.h>

// A recording in, a stack of range images with all rows out, which numpy reads.
int main(int argc, char** argv) {
  if (argc != 3) return 2;
  auto recording = hqslam::recordings::Recording::open(argv[1]);
  hqslam::pipeline::Upsampler upsampler(recording.sensor(), {.method = "du-mix"});
  hqslam::NpyStackWriter images(argv[2], upsampler.sensor().rows(), upsampler.sensor().columns);
  while (const auto scan = recording.next()) {
    const auto measured = upsampler.measured(scan->cloud);
    images.append(hqslam::range_image(upsampler.upsampled(measured)));
  }
}

#include <hqslam/core/npy.h>
#include <hqslam/nn/super_resolver.h>

// A stack of 16-row range images in, a stack of all rows out.
int main(int argc, char** argv) {
  if (argc != 4) return 2;
  auto network = hqslam::nn::SuperResolver::load(argv[1]);
  hqslam::NpyStackReader scans(argv[2]);
  hqslam::NpyStackWriter upsampled(argv[3], network.sensor().rows(), network.sensor().columns);
  for (std::int64_t i = 0; i < scans.images(); ++i)
    upsampled.append(network.run(scans.read(i)).image);
}

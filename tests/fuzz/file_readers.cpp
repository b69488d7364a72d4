#include "input_file.h"
#include "made_images.h"
#include "opened_files.h"

namespace hqslam::fuzz {
namespace {

/// To images, as hqslam run reads a recording.
void read_scans(const std::string& path) {
  // Few columns: the readers are to be fed, not the projection.
  const auto source = test::open_scan_files(path, test::preset_with("vlp-16", 32));
  while (source->next()) continue;
}

}  // namespace

void npy(Bytes input) { read_scans(as_file(input, ".npy")); }

void ply(Bytes input) { read_scans(as_file(input, ".ply")); }

void kitti_bin(Bytes input) { read_scans(as_file(input, ".bin")); }

void text(Bytes input) { read_scans(as_file(input, ".csv")); }

void found_sensor(Bytes input) {
  recordings::find_sensor_of_files({as_whole_file(input, ".csv")}, {});
}

void stamps(Bytes input) { recordings::read_stamps_s(as_whole_file(input, ".txt")); }

}  // namespace hqslam::fuzz

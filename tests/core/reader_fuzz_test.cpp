#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <random>
#include <string>

#include "damaged.h"
#include "error_message.h"
#include "file_contents.h"
#include "golden_folder.h"
#include "hqslam/core/kitti_bin.h"
#include "hqslam/core/npy.h"
#include "hqslam/core/npz.h"
#include "hqslam/core/pcd.h"
#include "hqslam/core/projection.h"
#include "hqslam/core/ring_recovery.h"
#include "hqslam/core/scan_source.h"
#include "hqslam/core/trajectory.h"
#include "temporary_directory.h"

using namespace hqslam;
using namespace hqslam::test;

// Every reader is given damaged copies of valid files, the same ones in every run. It must either
// read them or throw Error with a message of one line; under the sanitizers this shows reads and
// writes out of bounds and undefined behaviour as well.

namespace {

using Read = std::function<void(const std::string& path)>;

/// Writes over a file in place: replacing it costs some file systems milliseconds.
void overwrite(const std::string& path, const std::string& contents) {
  std::fstream stream(path, std::ios::binary | std::ios::in | std::ios::out);
  stream.write(contents.data(), static_cast<std::streamsize>(contents.size()));
  stream.close();
  std::filesystem::resize_file(path, contents.size());
}

/// Feeds the reader; counts what was read and what was refused.
void feed(const std::string& valid, const std::string& name, int copies, const Read& read) {
  const TemporaryDirectory directory;
  const std::string path = directory.file(name);
  std::mt19937 random(2024);
  write_file(path, valid);
  REQUIRE_NOTHROW(read(path));
  int refused = 0;
  for (int copy = 0; copy < copies; ++copy) {
    const std::string contents = damaged(valid, random);
    // The beginning of a file is where its parser works: damage it more often than the rest.
    const std::size_t head = std::min<std::size_t>(valid.size(), 300);
    overwrite(path, copy % 2 == 0 ? contents
                                  : damaged(valid.substr(0, head), random) + valid.substr(head));
    CAPTURE(copy);
    try {
      read(path);
    } catch (const Error& error) {
      ++refused;
      CHECK(one_line_with(error.what()));
    } catch (const std::exception& error) {
      FAIL_CHECK("not an hqslam::Error: " << error.what());
    }
  }
  CHECK(refused > copies / 20);  // the damage is worth the name
  CHECK(refused < copies);
}

std::string written(const std::function<void(const std::string&)>& write) {
  const TemporaryDirectory directory;
  write(directory.file("valid"));
  return file_contents(directory.file("valid"));
}

RangeImage an_image(const SensorModel& sensor) {
  RangeImage image(sensor.rows(), sensor.columns);
  for (std::size_t i = 0; i < image.range_m.size(); ++i) {
    image.range_m[i] = 5.0F + static_cast<float>(i % 7);
  }
  return image;
}

SensorModel a_small_sensor() {
  SensorModel sensor = sensor_preset("vlp-16");
  sensor.columns = 32;
  return sensor;
}

Scan a_scan() {
  Scan scan;
  for (const Eigen::Vector3f& point :
       unproject(an_image(a_small_sensor()), a_small_sensor(), CaptureTime::kMotionCorrected)
           .points_m) {
    scan.points_m.push_back(point);
  }
  return scan;
}

std::string pcd_of(const std::string& data, const std::string& body) {
  return "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z ring t\nSIZE 4 4 4 2 4\nTYPE F F F U U\n"
         "COUNT 1 1 1 1 1\nWIDTH 4\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 4\nDATA " +
         data + "\n" + body;
}

}  // namespace

TEST_CASE("damaged .npy stacks are read or refused, nothing else") {
  const std::string valid = written([](const std::string& path) {
    NpyStackWriter writer(path, 16, 32);
    for (int i = 0; i < 3; ++i) writer.append(an_image(a_small_sensor()));
  });
  feed(valid, "scans.npy", 5000, [](const std::string& path) {
    const auto source = open_recording(path, a_small_sensor());
    while (source->next()) {
    }
  });
}

TEST_CASE("damaged .npz archives are read or refused, nothing else") {
  constexpr std::int64_t kLargestBytes = 1 << 20;
  const Read read = [](const std::string& path) { read_npz(path, kLargestBytes); };
  const std::string own = written([](const std::string& path) {
    NpzArrays arrays;
    arrays["weights"] = npz_array(std::vector<float>(60, 0.5F), {3, 4, 5});
    arrays["step"] = npz_array(std::vector<std::int64_t>{7}, {});
    arrays["note"] = npz_text("damage me");
    write_npz(path, arrays);
  });
  feed(own, "own.npz", 4000, read);
  // Stored members: their headers lie open to the damage. The directory is at the end of a file,
  // and small files have more of it.
  feed(file_contents(golden_folder() + "/numpy_stored.npz"), "stored.npz", 3000, read);
  feed(file_contents(golden_folder() + "/numpy_deflated.npz"), "deflated.npz", 3000, read);
}

TEST_CASE("damaged KITTI scans are read or refused, nothing else") {
  const std::string valid =
      written([](const std::string& path) { write_kitti_bin(a_scan(), path); });
  feed(valid, "0.bin", 4000, [](const std::string& path) {
    const auto source = open_recording(path, a_small_sensor());
    while (source->next()) {
    }
  });
}

TEST_CASE("damaged .pcd files of every kind are read or refused, nothing else") {
  const SensorModel sensor = a_small_sensor();
  const Read read = [&](const std::string& path) { project(read_pcd(path, sensor), sensor); };
  const std::string ascii = "5 0 1 3 0\n5 0 0 7 1000\n5 0 -1 11 2000\n5 1 -1 11 3000\n";
  feed(pcd_of("ascii", ascii), "0.pcd", 5000, read);
  // Four points of 18 bytes: any bytes will do, zeros are points without a return.
  const std::string zeros(72, '\0');
  feed(pcd_of("binary", zeros), "0.pcd", 5000, read);
  std::string stream = {8, 0, 0, 0, 72, 0, 0, 0};
  stream += std::string{0, 0, static_cast<char>(7 << 5), 62, 0, 0, 0, 0};
  stream[0] = 5;
  feed(pcd_of("binary_compressed", stream), "0.pcd", 6000, read);
}

TEST_CASE("damaged sensor files are read or refused, nothing else") {
  const std::string own =
      written([](const std::string& path) { write_sensor_json(sensor_preset("vlp-16"), path); });
  const Read read = [](const std::string& path) { validate(read_sensor_json(path)); };
  feed(own, "sensor.json", 5000, read);
  const std::string ouster = R"({"beam_intrinsics": {"beam_altitude_angles": [10, 0, -10.5],
    "beam_azimuth_angles": [3, -3, 1]}, "lidar_data_format": {"columns_per_frame": 512},
    "config_params": {"lidar_mode": "512x20"}})";
  feed(ouster, "ouster.json", 5000, read);
}

TEST_CASE("damaged trajectories are read or refused, nothing else") {
  Trajectory trajectory;
  for (int i = 0; i < 20; ++i) {
    trajectory.push_back({0.1 * i, pose_from_xyz_rpy({1.0 * i, 2, 3}, 0.1 * i, 0.2, -0.3)});
  }
  const Read read = [](const std::string& path) {
    path_length_m(read_trajectory_file(path).poses);
  };
  feed(written([&](const std::string& path) { write_tum(trajectory, path); }), "t.tum", 5000, read);
  feed(written([&](const std::string& path) { write_kitti_poses(trajectory, path); }), "t.kitti",
       5000, read);
}

#include <sys/stat.h>

#include "hqslam/core/kitti_bin.h"
#include "made_images.h"
#include "points_file.h"
#include "recording_complaint.h"

using namespace hqslam::recordings;

namespace {

/// Walls at different distances and the ground; some pixels without a return.
RangeImage an_image(const SensorModel& sensor, double shift_m = 0.0) {
  return made_image(sensor.rows(), sensor.columns, [&](int row, int column) {
    const double tangent = std::tan(sensor.beam_elevation_rad[row]);
    const double wall_m = 12.0 + shift_m + 4.0 * std::cos(6.28 * column / sensor.columns);
    const double distance_m = std::min(wall_m, tangent < 0.0 ? 1.7 / -tangent : 1e3);
    return (column / 100) % 5 == 4 ? 0.0 : distance_m * std::hypot(1.0, tangent);
  });
}

Scan as_scan(const RangeImage& image, const SensorModel& sensor) {
  Scan scan;
  scan.points_m = points_of(unproject(image, sensor, CaptureTime::kMotionCorrected));
  return scan;
}

}  // namespace

TEST_CASE("a folder of KITTI files gives the images that they were made from, in natural order") {
  for (const std::string name : {"os1-16", "os1-64", "vlp-16"}) {
    CAPTURE(name);
    const TemporaryDirectory directory;
    const SensorModel sensor = sensor_preset(name);
    for (const int number : {10, 9, 8}) {
      write_kitti_bin(as_scan(an_image(sensor, number), sensor),
                      directory.file(std::to_string(number) + ".bin"));
    }
    const auto source = open_scan_files(directory.path(), sensor);
    CHECK(source->size() == 3);
    CHECK(source->sensor() == sensor);
    for (int i = 0; i < 3; ++i) {
      const auto scan = source->next().value();
      CHECK(scan.name == directory.file(std::to_string(8 + i) + ".bin"));
      CHECK(scan.stamp_s == doctest::Approx(0.1 * i));
      CHECK(std::ranges::equal(scan.cloud.range_m, an_image(sensor, 8 + i).range_m,
                               [](float a, float b) { return std::abs(a - b) < 1e-3F; }));
      CHECK(scan.cloud.time_offset_s.empty());
    }
    CHECK_FALSE(source->next());
  }
}

TEST_CASE("an .npy stack gives its images, in either order of rows, rolling or corrected") {
  const TemporaryDirectory directory;
  const SensorModel sensor = sensor_preset("os1-16");
  const std::string path = directory.file("scans.npy");
  const RangeImage image = an_image(sensor);
  const RangeImage flipped = made_image(image.rows, image.columns, [&](int row, int column) {
    return image.at(image.rows - 1 - row, column);
  });
  write_stack(path, {image, flipped});
  const auto source = open_scan_files(path, sensor);
  CHECK(source->size() == 2);
  const auto first = source->next();
  CHECK(first->cloud.range_m == image.range_m);
  CHECK(first->cloud.time_offset_s.size() == image.range_m.size());
  CHECK(first->name == path + "[0]");
  CHECK(source->next()->cloud.range_m == flipped.range_m);
  const auto upside_down =
      open_scan_files(path, sensor, {RowOrder::kLowestFirst, CaptureTime::kMotionCorrected});
  CHECK(upside_down->next()->cloud.range_m == flipped.range_m);
  const auto second = upside_down->next();
  CHECK(second->cloud.range_m == image.range_m);
  CHECK(second->cloud.time_offset_s.empty());
  CHECK(second->stamp_s == doctest::Approx(0.1));
}

TEST_CASE("bad pixels and pixels out of range are counted and left out") {
  const TemporaryDirectory directory;
  const SensorModel sensor = sensor_preset("os1-16");
  RangeImage image = an_image(sensor);
  const std::int64_t pixels =
      std::ranges::count_if(image.range_m, [](float range_m) { return range_m > 0.0F; });
  image.at(0, 0) = std::numeric_limits<float>::quiet_NaN();
  image.at(0, 1) = std::numeric_limits<float>::infinity();
  image.at(0, 2) = -3.0F;
  image.at(0, 3) = 1e6F;
  image.at(0, 4) = 0.01F;
  write_stack(directory.file("scans.npy"), {image});
  const auto source = open_scan_files(directory.file("scans.npy"), sensor);
  CHECK(source->warnings().empty());
  const auto scan = source->next().value();
  CHECK(one_line_with(source->warnings(), "1 pixels", "120 m", "os1-16"));
  CHECK(scan.invalid_points == 3);
  CHECK(scan.counts.out_of_range == 2);
  CHECK(scan.counts.kept == pixels - 5);
  for (int column = 0; column < 5; ++column) CHECK(scan.cloud.range_m[column] == 0.0F);
}

TEST_CASE("a simulated drive is opened with the sensor it was made with and no other") {
  const TemporaryDirectory directory;
  const SensorModel sensor = sensor_preset("hdl-32e");
  const RangeImage image = an_image(sensor);
  write_sensor_json(sensor, directory.file("sensor.json"));
  write_stack(directory.file("scans.npy"), {image});
  const std::string path = directory.path();
  const auto scan = open_scan_files(path, sensor)->next();
  CHECK(scan->cloud.range_m == image.range_m);
  CHECK_FALSE(scan->cloud.time_offset_s.empty());
  SensorModel tilted = sensor;
  tilted.beam_elevation_rad[3] += 1e-3;
  CHECK(recording_refused(path, tilted, path, "expected", "hdl-32e", "found", "sensor.json"));
  CHECK(
      recording_refused(path, sensor_preset("os1-64"), "'os1-64' (64 rows", "'hdl-32e' (32 rows"));
  SensorModel slow = sensor;
  slow.scan_period_s = 0.2;
  CHECK(recording_refused(path, slow, "0.2 s a scan", "found", "0.1 s a scan"));
}

TEST_CASE("what a folder's sensor file says of its images holds whatever the sensor is called") {
  const TemporaryDirectory directory;
  const SensorModel preset = sensor_preset("hdl-32e");
  SensorModel upsampled = preset;
  upsampled.measured_rows = RowSelection{3, 4};
  upsampled.motion_corrected = true;
  write_sensor_json(upsampled, directory.file("sensor.json"));
  write_stack(directory.file("scans.npy"), {an_image(preset)});
  const std::string path = directory.path();
  const auto source = open_scan_files(path, preset);
  CHECK(source->sensor() == upsampled);
  CHECK(source->next()->cloud.time_offset_s.empty());

  // The same stack alone is taken as the caller says.
  CHECK_FALSE(open_scan_files(path + "/scans.npy", preset)->next()->cloud.time_offset_s.empty());
  CHECK(open_scan_files(path + "/scans.npy", upsampled)->next()->cloud.time_offset_s.empty());
  write_sensor_json(preset, directory.file("sensor.json"));
  const RecordingOptions corrected{RowOrder::kHighestFirst, CaptureTime::kMotionCorrected};
  CHECK(open_scan_files(path, preset, corrected)->next()->cloud.time_offset_s.empty());
}

TEST_CASE("a KITTI drive is opened by the folder above its scans") {
  const TemporaryDirectory directory;
  const SensorModel sensor = sensor_preset("os1-16");
  std::filesystem::create_directory(directory.file("velodyne"));
  write_kitti_bin(as_scan(an_image(sensor), sensor), directory.file("velodyne/0.bin"));
  write_file(directory.file("timestamps.txt"), "2011-09-26\n");
  CHECK(open_scan_files(directory.path(), sensor)->size() == 1);
}

TEST_CASE("a path that is no recording is refused in one line") {
  const TemporaryDirectory directory;
  const SensorModel sensor = sensor_preset("os1-16");
  const std::string path = directory.path();
  CHECK(recording_refused("/nowhere", sensor, "/nowhere", "no such", "give a capture"));
  CHECK(recording_refused(path, sensor, path, "empty folder", ".bin or .pcd"));
  write_file(directory.file("readme.md"), "hello");
  CHECK(recording_refused(path, sensor, path, "found none"));
  CHECK(recording_refused(directory.file("readme.md"), sensor, "'.md'"));
  write_file(directory.file("readme.txt"), "hello");  // a kind of recording, but no points in it
  CHECK(recording_refused(directory.file("readme.txt"), sensor, "columns x y z"));
  write_file(directory.file("a.npy"), "not numpy");
  CHECK(recording_refused(path, sensor, "a.npy", "give the path"));
  CHECK(recording_refused(directory.file("a.npy"), sensor, "a.npy", "NUMPY"));
  write_file(directory.file("0.bin"), "text, not a scan");
  CHECK(recording_refused(path, sensor, "0.bin", "text"));
  write_file(directory.file("0.pcd"), "");
  CHECK(recording_refused(path, sensor, path, "one kind", "1 .bin and 1 .pcd"));
}

TEST_CASE("broken links and files that are no scans are named, and later scans keep their stamps") {
  const TemporaryDirectory directory;
  const SensorModel sensor = sensor_preset("os1-16");
  for (const char* name : {"0.bin", "4.bin"}) {
    write_kitti_bin(as_scan(an_image(sensor), sensor), directory.file(name));
  }
  std::filesystem::create_symlink(directory.file("nowhere"), directory.file("1.bin"));
  std::filesystem::create_symlink(directory.file("2.bin"), directory.file("2.bin"));
  REQUIRE(mkfifo(directory.file("3.bin").c_str(), 0600) == 0);
  std::filesystem::create_directory(directory.file("5.bin"));  // a folder is no scan
  const auto source = open_scan_files(directory.path(), sensor);
  CHECK(source->size() == 5);
  CHECK(source->next()->stamp_s == 0.0);
  for (const char* name : {"1.bin", "2.bin"}) {
    CHECK(refused_with([&] { source->next(); }, name, "found no file"));
  }
  CHECK(refused_with([&] { source->next(); }, "3.bin", "found a pipe or a device"));
  CHECK(source->read_share() == doctest::Approx(0.8));
  CHECK(source->next()->stamp_s == doctest::Approx(0.4));
  CHECK_FALSE(source->next());
}

TEST_CASE("scans of another sensor or in other units are refused") {
  const TemporaryDirectory directory;
  const SensorModel os1_64 = sensor_preset("os1-64");
  const Scan scan = as_scan(an_image(os1_64), os1_64);
  write_kitti_bin(scan, directory.file("0.bin"));
  write_points(scan.points_m, directory.file("0.pcd"));
  for (const std::string name : {"os1-16", "vlp-16", "hdl-64e", "vls-128"}) {
    CAPTURE(name);
    CHECK(recording_refused(directory.file("0.bin"), sensor_preset(name), "0.bin", name,
                            "name the sensor"));
  }
  std::vector<Eigen::Vector3f> in_mm = scan.points_m;
  for (Eigen::Vector3f& point : in_mm) point *= 1000.0F;
  write_points(in_mm, directory.file("mm.pcd"));
  CHECK(recording_refused(directory.file("mm.pcd"), os1_64, "mm.pcd", "metres"));
  std::vector<Eigen::Vector3f> above = scan.points_m;
  for (Eigen::Vector3f& point : above) point.z() = point.norm();
  write_points(above, directory.file("above.pcd"));
  CHECK(recording_refused(directory.file("above.pcd"), os1_64, "above.pcd", "outside",
                          "name the sensor"));

  RangeImage image = an_image(os1_64);
  for (float& range : image.range_m) range *= 1000.0F;
  write_stack(directory.file("mm.npy"), {image});
  CHECK(recording_refused(directory.file("mm.npy"), os1_64, "mm.npy[0]", "metres"));
  CHECK(recording_refused(directory.file("mm.npy"), sensor_preset("os1-16"), "mm.npy", "16 x 1024",
                          "64 x 1024"));
  const NpyStackWriter no_images(directory.file("none.npy"), 64, 1024);
  CHECK(recording_refused(directory.file("none.npy"), os1_64, "none.npy", "one image"));
}

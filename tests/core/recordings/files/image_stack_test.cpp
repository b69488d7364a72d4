#include "hqslam/core/trajectory.h"
#include "made_images.h"
#include "recording_complaint.h"

using namespace hqslam::recordings;

namespace {

RangeImage a_wall(const SensorModel& sensor) {
  return flat_image(sensor.rows(), sensor.columns, 5.0F);
}

/// A folder with images of a VLP-16, a sensor file beside them.
struct ImageFolder : TemporaryDirectory {
  SensorModel sensor = sensor_preset("vlp-16");

  explicit ImageFolder(int images) {
    write_sensor_json(sensor, file("sensor.json"));
    NpyStackWriter writer(file("scans.npy"), 16, sensor.columns);
    for (int i = 0; i < images; ++i) writer.append(a_wall(sensor));
  }
  std::unique_ptr<ScanSource> open(const RecordingOptions& options = {}) const {
    return open_scan_files(path(), sensor, options);
  }
  bool refused(const auto&... parts) const { return recording_refused(path(), sensor, parts...); }
};

}  // namespace

TEST_CASE("an image that cannot be the sensor's is left out of its stack, the next one comes") {
  const TemporaryDirectory directory;
  const SensorModel sensor = sensor_preset("vlp-16");
  const auto stack = [&](int images, const auto& is_good) {
    const RangeImage foreign = flat_image(sensor.rows(), sensor.columns, 5000.0F);
    NpyStackWriter writer(directory.file("scans.npy"), 16, sensor.columns);
    for (int i = 0; i < images; ++i) writer.append(is_good(i) ? a_wall(sensor) : foreign);
    return open_scan_files(directory.file("scans.npy"), sensor);
  };
  const auto one_is_not = stack(4, [](int i) { return i != 1; });
  CHECK(one_is_not->next());
  CHECK_THROWS_AS(one_is_not->next(), ScanError);
  CHECK(one_is_not->next()->stamp_s == doctest::Approx(0.2));
  CHECK(one_is_not->next()->name.ends_with("[3]"));
  CHECK_FALSE(one_is_not->next());
  // A stack whose first images all are foreign is another sensor's.
  CHECK(is_given_up_at_tenth(*stack(12, [](int) { return false; })));
}

TEST_CASE("a scan whose pixels are mostly too near, as under a cover, is read with the others") {
  const TemporaryDirectory directory;
  const SensorModel sensor = sensor_preset("vlp-16");
  const float near_m = 0.5F * static_cast<float>(sensor.min_range_m);
  RangeImage covered = a_wall(sensor);
  std::fill(covered.range_m.begin(), covered.range_m.begin() + 15 * sensor.columns, near_m);
  const auto first_of = [&](const RangeImage& image) {
    NpyStackWriter(directory.file("scans.npy"), 16, sensor.columns).append(image);
    return open_scan_files(directory.file("scans.npy"), sensor)->next();
  };
  CHECK(first_of(covered)->counts.kept == sensor.columns);
  covered.range_m.assign(covered.range_m.size(), near_m);  // nothing else: another unit
  CHECK(refused_with([&] { first_of(covered); }, "give ranges in metres"));
}

TEST_CASE("the scans of a drive have the stamps of its truth, also where it was interrupted") {
  const ImageFolder folder(3);
  const auto with_truth_of = [&](int poses) {
    Trajectory truth;
    for (int i = 0; i < poses; ++i) truth.push_back({0.05 + 0.1 * i, Pose::Identity()});
    write_tum(truth, folder.file("truth.tum"));
  };
  // Of a whole drive, of one that was upsampled in part, of one whose last pose is missing.
  for (const int poses : {3, 5, 2}) {
    CAPTURE(poses);
    with_truth_of(poses);
    const auto source = folder.open();
    for (int i = 0; i < 3; ++i) CHECK(source->next()->stamp_s == doctest::Approx(0.05 + 0.1 * i));
  }
  with_truth_of(1);
  CHECK(folder.refused("scans.npy", "3 images", "found 1", "truth.tum"));
}

TEST_CASE("the files beside the images of a folder describe their pixels") {
  const ImageFolder folder(0);
  RangeImage image = a_wall(folder.sensor);
  image.at(0, 0) = 0.0F;
  write_stack(folder.file("scans.npy"), {image});
  CHECK(folder.open()->next()->cloud.intensity.empty());
  CHECK(folder.open()->next()->cloud.confidence.empty());
  RangeImage beside = image;
  beside.at(0, 0) = beside.at(0, 1) = 3.0F;
  beside.at(0, 2) = std::nanf("");
  write_stack(folder.file("confidence.npy"), {beside});
  write_stack(folder.file("intensity.npy"), {beside});
  OrganizedCloud cloud = folder.open()->next()->cloud;
  CHECK(std::vector(cloud.confidence.begin(), cloud.confidence.begin() + 3) ==
        std::vector{0.0F, 1.0F, 0.0F});
  CHECK(cloud.intensity[0] == 0.0F);
  CHECK(cloud.intensity[1] == 3.0F);
  CHECK(std::isnan(cloud.intensity[2]));

  std::vector<std::uint8_t> bytes(image.range_m.size());
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(i);
  NpyArrayWriter<std::uint8_t>(folder.file("intensity.npy"), {16, image.columns}).append(bytes);
  cloud = folder.open()->next()->cloud;
  for (std::size_t i = 0; i < bytes.size(); ++i) REQUIRE(cloud.intensity[i] == bytes[i]);
  write_file(folder.file("confidence.npy"), file_contents(folder.file("intensity.npy")));
  CHECK(folder.refused("confidence.npy", "'<f4'", "'|u1'"));
  write_stack(folder.file("confidence.npy"), {RangeImage(16, 7)});
  CHECK(folder.refused("confidence.npy", "1 images", "16 x 7"));
}

TEST_CASE("images have the stamps that they are given, which go before those in their folder") {
  const ImageFolder folder(2);
  const std::string given = folder.file("given.txt");
  write_tum({{1.0, Pose::Identity()}, {2.0, Pose::Identity()}}, folder.file("truth.tum"));
  write_file(folder.file("timestamps.txt"), "3\n4.5\n");
  write_file(given, "5\n6.5\n");
  const auto second_stamp_s = [&](const std::string& path, const std::string& stamps) {
    const auto source = open_scan_files(path, folder.sensor, {.stamps = stamps});
    source->next();
    return source->next()->stamp_s;
  };
  CHECK(second_stamp_s(folder.file(""), "") == 4.5);
  CHECK(second_stamp_s(folder.file(""), given) == 6.5);
  CHECK(second_stamp_s(folder.file("scans.npy"), "") == folder.sensor.scan_period_s);
  CHECK(second_stamp_s(folder.file("scans.npy"), given) == 6.5);
  CHECK(second_stamp_s(folder.file("scans.npy"), "0.25") == 0.25);
  CHECK(second_stamp_s(folder.file(""), "0.25") == 0.25);
  for (const char* stamps : {"5\n6.5\n8\n", "5\n"}) {  // of more images or fewer
    write_file(given, stamps);
    CHECK(refused_with([&] { second_stamp_s(folder.file(""), given); }, "each of 2 images"));
  }
  CHECK(refused_with([&] { second_stamp_s(folder.file(""), kStampsFromNames); },
                     "numbers in their names", "a file with a stamp per image"));
}

TEST_CASE("rows that hold nothing in the images of a stack are left out, and named") {
  const TemporaryDirectory directory;
  const SensorModel sensor = sensor_preset("os1-64");
  RangeImage every_fourth(64, sensor.columns);
  for (int row = 3; row < 64; row += 4) {
    std::fill_n(&every_fourth.at(row, 0), sensor.columns, 10.0F + static_cast<float>(row));
  }
  write_stack(directory.file("a.npy"), {every_fourth});
  const auto source = open_scan_files(directory.file("a.npy"), sensor);
  CHECK(source->sensor().beam_elevation_rad == sensor_preset("os1-16").beam_elevation_rad);
  CHECK(source->warnings().at(0).find("only rows 3, 7, ... 63 of 64") != std::string::npos);
  const auto scan = source->next().value();
  CHECK(scan.cloud.range_m[scan.cloud.index(1, 0)] == 17.0F);

  RangeImage uneven(64, sensor.columns);
  for (const int row : {3, 4, 8, 20, 21, 33, 40}) uneven.at(row, 7) = 10.0F;
  write_stack(directory.file("b.npy"), {uneven});
  const auto with_holes = open_scan_files(directory.file("b.npy"), sensor);
  CHECK(with_holes->sensor().rows() == 64);
  CHECK(with_holes->warnings().at(0).find("31 of the 38 rows 3 to 40") != std::string::npos);
}

TEST_CASE("a stack has the sensor of the file beside it, if its rows fit, or a named one") {
  const TemporaryDirectory directory;
  SensorModel sensor = sensor_preset("os1-16");
  sensor.name = "mine";
  write_sensor_json(sensor, directory.file("sensor.json"));
  const std::string stack = directory.file("scans.npy");
  write_stack(stack, {a_wall(sensor)});
  CHECK(Recording::open(stack).sensor().name == "mine");
  CHECK(Recording::open(stack, {.sensor = "os1-16"}).sensor().name == "os1-16");
  write_sensor_json(sensor_preset("os1-64"), directory.file("sensor.json"));
  CHECK(refused_with([&] { Recording::open(stack); }, "scans.npy", "--sensor"));
}

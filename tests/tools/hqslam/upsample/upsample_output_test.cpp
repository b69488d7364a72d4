#include "upsample/upsample_output.h"

#include "hqslam/core/cloud_file.h"
#include "hqslam/recordings/recording.h"
#include "made_images.h"
#include "tools/parts_of_text.h"

namespace hqslam::tools {
namespace {

namespace fs = std::filesystem;

const SensorModel kSixteen = sensor_preset("os1-16");

/// Writes `scans` scans into `folder`.
void write_scans(const std::string& folder, int scans, UpsampledFormats formats = {}) {
  UpsampleOutput output(folder, {"input", "linear", scans}, kSixteen, formats);
  RangeImage image(16, 1024);
  image.at(3, 7) = 10.0F;
  for (int i = 0; i < scans; ++i) {
    output.append(image, unproject(image, kSixteen, CaptureTime::kRolling), 0.5 + 0.25 * i);
  }
}

}  // namespace

TEST_CASE("an upsampled drive is a stack with its sensor, and one file per scan where asked for") {
  const TemporaryDirectory folder;
  write_scans(folder.file("plain"), 3);
  CHECK(names_in(folder.file("plain")) ==
        std::set<std::string>{"scans.npy", "sensor.json", "timestamps.txt", "upsample.json"});
  CHECK(file_contents(folder.file("plain/timestamps.txt")) ==
        "0.500000000\n0.750000000\n1.000000000\n");
  NpyStackReader stack(folder.file("plain/scans.npy"));
  CHECK(stack.images() == 3);
  CHECK(stack.read(2).at(3, 7) == 10.0F);
  CHECK(read_sensor_json(folder.file("plain/sensor.json")).rows() == 16);

  write_scans(folder.file("all"), 2, {true, true});
  for (const std::string kind : {"bin", "pcd"}) {
    CHECK(names_in(folder.file("all/" + kind)) == std::set{"000000." + kind, "000001." + kind});
  }
  CHECK(read_cloud(folder.file("all/pcd/000001.pcd")).points_m.size() == 1);
}

TEST_CASE("intensities have a stack of their own, where a scan has none they are not known") {
  const TemporaryDirectory folder;
  UpsampleOutput output(folder.file("out"), {"input", "linear", 3}, kSixteen, {});
  RangeImage image(16, 1024);
  image.at(3, 7) = 10.0F;
  OrganizedCloud cloud = unproject(image, kSixteen, CaptureTime::kRolling);
  output.append(image, cloud, 0.0);
  cloud.intensity.assign(cloud.range_m.size(), 300.5F);
  output.append(image, cloud, 0.1);
  cloud.intensity.clear();
  output.append(image, cloud, 0.2);
  auto upsampled = recordings::Recording::open(folder.file("out"));
  const auto intensity = [&] { return returns_of(upsampled.next()->cloud).intensity; };
  CHECK(std::isnan(intensity().at(0)));
  CHECK(intensity() == std::vector{300.5F});
  CHECK(std::isnan(intensity().at(0)));
}

TEST_CASE("a sensor that begins its turns anywhere has the times of its scans in the stack too") {
  const TemporaryDirectory folder;
  UpsampleOutput output(folder.file("out"), {"input", "linear", 3}, kSixteen, {});
  RangeImage image = flat_image(16, 1024, 10.0F);
  std::vector<OrganizedCloud> clouds;
  for (const int first : {0, 700, 3}) {
    image.range_m[0] += 1.0F;  // no two scans of a real sensor are the same
    clouds.push_back(unproject(image, kSixteen, CaptureTime::kRolling, first));
    output.append(image, clouds.back(), 0.1);
  }
  CHECK(file_contents(folder.file("out/first_columns.txt")) == "0\n700\n3\n");
  auto source = recordings::Recording::open(folder.file("out"));
  for (const OrganizedCloud& cloud : clouds) {
    CHECK(source.next()->cloud.time_offset_s == cloud.time_offset_s);
  }

  for (const char* wrong : {"0\n1\n", "0\n1\n1024\n", "0\n-1\n2\n", "0\n1\nsecond\n"}) {
    write_file(folder.file("out/first_columns.txt"), wrong);
    CHECK(refused_with([&] { recordings::Recording::open(folder.file("out")); },
                       "first_columns.txt"));
  }
}

TEST_CASE("upsample.json says whether all scans were taken, and by which poses they recalled") {
  const TemporaryDirectory folder;
  UpsampleOutput output(folder.file("out"), {"input", "linear", 7, "poses.tum"}, kSixteen, {});
  const std::string origin = folder.file("out/upsample.json");
  CHECK(missing(file_contents(origin), {"\"complete\": false", "\"scans_in_recording\": 7",
                                        "\"poses\": \"poses.tum\""}) == "");
  output.finish(7);
  CHECK(holds(file_contents(origin), "\"complete\": true"));
  // How many scans a capture has is not said before it was read to its end.
  UpsampleOutput capture(folder.file("live"), {"input", "linear"}, kSixteen, {});
  CHECK(holds(file_contents(folder.file("live/upsample.json")), "\"scans_in_recording\": null"));
  capture.finish(5);
  CHECK(holds(file_contents(folder.file("live/upsample.json")), "\"scans_in_recording\": 5"));
}

TEST_CASE("an earlier upsampled drive is replaced whole; other files stay") {
  const TemporaryDirectory folder;
  const std::string out = folder.file("out");
  write_scans(out, 3, {false, true});
  write_file(out + "/notes.txt", "mine");
  write_file(out + "/pcd/notes.txt", "mine");
  write_file(out + "/pcd/mine.pcd", "mine");
  write_scans(out, 1);
  CHECK(NpyStackReader(out + "/scans.npy").images() == 1);
  CHECK(names_in(out + "/pcd") == std::set<std::string>{"mine.pcd", "notes.txt"});
  CHECK(file_contents(out + "/notes.txt") == "mine");
}

TEST_CASE("the truth and the inertial data of a simulated drive go along") {
  const TemporaryDirectory folder;
  fs::create_directory(folder.file("drive"));
  write_file(folder.file("drive/truth.tum"), "0.05 0 0 0 0 0 0 1\n");
  write_file(folder.file("drive/imu.csv"), "0,0,0,0,0,0,9.81\n");
  const UpsampleOutput output(folder.file("out"), {folder.file("drive"), "linear", 1}, kSixteen,
                              {});
  CHECK(file_contents(folder.file("out/truth.tum")) == "0.05 0 0 0 0 0 0 1\n");
  CHECK(file_contents(folder.file("out/imu.csv")) == "0,0,0,0,0,0,9.81\n");
}

}  // namespace hqslam::tools

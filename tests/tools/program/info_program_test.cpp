#include "core/recordings/captures.h"
#include "hqslam/core/cloud_file.h"
#include "made_images.h"
#include "tools/program/program.h"

namespace hqslam::test {

TEST_CASE("a capture is explained by info, and the command that it names runs") {
  auto packets = velodyne_capture({.rate_hz = 20.0, .duration_s = 0.31});
  packets.erase(packets.begin() + 100);
  packets.push_back({packets.back().time_ns, 8308, Payload(512)});
  const Capture capture(packets);
  const std::string& path = capture.path;
  const ProgramResult info = succeeds("info '{}'", path);
  CHECK(missing(info.out, {"pcap capture", "192.168.1.201:2368", "Velodyne packets, single return",
                           "vlp-16: 16 rows x 900 columns, 20", "6 in 0.3", "1 lost",
                           "each with its own time", "1 packet was lost", " --out results",
                           "192.168.1.201:8308, 1 packets of positions, no scans"}) == "");
  CHECK(holds(info.out, fmt::format("hqslam run {}", path)));
  succeeds("run '{}' --out '{}'", path, capture.folder.file("results"));
  const auto poses = read_tum(capture.folder.file("results/trajectory.tum"));
  REQUIRE(poses.size() == 6);
  CHECK(poses[3].stamp_s - poses[2].stamp_s == doctest::Approx(0.05).epsilon(0.02));
  CHECK(poses[0].stamp_s > 1.5e9);  // the recording's own
}

TEST_CASE("info names no command for a recording that cannot be read as that sensor's") {
  const std::string bin = simulated_drive() + "/bin";
  CHECK(holds(succeeds("info '{}' --sensor os1-16", bin).out, "hqslam run"));
  CHECK(holds(refused("info '{}' --sensor hdl-64e", bin), "name the sensor"));
  CHECK_FALSE(holds(run_hqslam("info '{}' --sensor hdl-64e", bin).out, "hqslam run"));
}

TEST_CASE("without a sensor info finds it in the points and writes it, and run takes that file") {
  const TemporaryDirectory folder;
  const std::string bin = simulated_drive() + "/bin";
  const std::string file = folder.file("found.json");
  const ProgramResult info = succeeds("info '{}' --write-sensor '{}'", bin, file);
  CHECK(missing(info.out, {"os1-16: 16 rows x 1024 columns", "sensor found in the points",
                           "beams       14.8 12.63 ", "those of os1-16", "hqslam run"}) == "");
  CHECK(read_sensor_json(file) == sensor_preset("os1-16"));
  CHECK(holds(refused("info '{}' --write-sensor '{}'", bin, file), file));

  const ProgramResult found = succeeds("run '{}' --out '{}'", bin, folder.file("found"));
  CHECK(holds(found.error, "sensor found in the points: 16 beams"));
  succeeds("run '{}' --sensor '{}' --out '{}'", bin, file, folder.file("named"));
  CHECK(file_contents(folder.file("found/trajectory.tum")) ==
        file_contents(folder.file("named/trajectory.tum")));
}

TEST_CASE("of points without times info says how they were captured, and names that to run") {
  const std::string bin = simulated_drive("--sensor os1-16 --scans 40 --seed 3") + "/bin";
  CHECK(missing(succeeds("info '{}'", bin).out,
                {"counted in turns of the sensor from 0 s", "as captured while the sensor turned",
                 fmt::format("hqslam run {} --capture rolling", bin)}) == "");
  CHECK_FALSE(holds(succeeds("info '{}'", simulated_drive() + "/bin").out, "--capture"));
}

TEST_CASE("run takes points without times as its scans show, KITTI's as corrected with a hint") {
  const std::string bin = simulated_drive("--sensor os1-16 --scans 40 --seed 3") + "/bin";
  const TemporaryDirectory folder;
  const std::string pcd = folder.file("pcd");
  fs::create_directory(pcd);
  for (const auto& file : fs::directory_iterator(bin)) {
    write_cloud(read_cloud(file.path().string()),
                fmt::format("{}/{}.pcd", pcd, file.path().stem().string()));
  }
  const auto ran = [&](const std::string& input, const char* options) {
    const std::string error =
        succeeds("run '{}' --sensor os1-16 --out '{}' {}", input, folder.file("out"), options)
            .error;
    return std::pair(error, file_contents(folder.file("out/trajectory.tum")));
  };
  const auto [error, trajectory] = ran(pcd, "");
  CHECK(holds(error, "read as with --capture rolling"));
  const auto [none, rolling] = ran(pcd, "--capture rolling");
  CHECK_FALSE(holds(none, "points have no times"));
  CHECK(trajectory == rolling);
  const auto [hint, corrected] = ran(bin, "");
  CHECK(holds(hint, "--capture rolling reads them"));
  CHECK(corrected == ran(bin, "--capture corrected").second);
  CHECK(corrected != rolling);
}

TEST_CASE("info takes images of a named sensor of which few rows hold returns") {
  const TemporaryDirectory folder;
  RangeImage image(64, 1024);
  for (int row = 3; row < 64; row += 4) {
    std::fill_n(&image.at(row, 0), image.columns, 5.0F + 0.1F * static_cast<float>(row));
  }
  NpyStackWriter stack(folder.file("ranges.npy"), image.rows, image.columns);
  for (int i = 0; i < 2; ++i) stack.append(image);
  const std::string path = folder.file("ranges.npy");
  CHECK(holds(succeeds("info '{}' --sensor os1-64", path).out, "hqslam run"));
}

TEST_CASE("info and run distinguish a folder of captures from one of scans") {
  const TemporaryDirectory folder;
  for (const char* name : {"b.pcap", "a.pcap"}) {
    write_file(folder.file(name), pcap_bytes(velodyne_capture({.duration_s = 0.11})));
  }
  for (const char* command : {"info", "run --out /nowhere"}) {
    CHECK(holds(refused("{} '{}'", command, folder.path()), folder.file("a.pcap")));
  }
}

TEST_CASE("info counts the scans that cannot be read, and says what is wrong with the first") {
  const TemporaryDirectory folder;
  const std::string bin = folder.file("bin");
  fs::copy(simulated_drive() + "/bin", bin);
  write_file(bin + "/x.bin", "junk");
  CHECK(holds(succeeds("info '{}'", bin).out, "1 scan was left out: " + bin + "/x.bin"));
  fs::create_symlink("nowhere", bin + "/link.bin");
  CHECK(holds(succeeds("info '{}'", bin).out,
              "2 scans were left out, the first of them: " + bin + "/link.bin"));

  const std::string path = folder.file("stack.npy");
  NpyStackWriter stack(path, 16, 1024);
  for (int i = 0; i < 120; ++i) {
    stack.append(flat_image(16, 1024, i < 4 ? 10.0F + 0.01F * static_cast<float>(i) : NAN));
  }
  CHECK(missing(succeeds("info '{}' --sensor os1-16", path).out,
                {"96 scans were left out, the first of them: " + path + "[4]",
                 "only the first 100 of 120 scans were examined"}) == "");
}

TEST_CASE("a folder that says that it was corrected for motion is not asked how it was captured") {
  const TemporaryDirectory folder;
  fs::copy(simulated_drive(), folder.file("drive"));
  const std::string sensor_file = folder.file("drive/sensor.json");
  CHECK(
      holds(succeeds("info '{}'", folder.file("drive")).out, "points      each with its own time"));
  SensorModel sensor = read_sensor_json(sensor_file);
  sensor.motion_corrected = true;
  write_sensor_json(sensor, sensor_file);
  const ProgramResult result = succeeds("info '{}'", folder.file("drive"));
  CHECK(holds(result.out, "corrected for motion"));
  CHECK_FALSE(holds(result.out, "captured    "));
}

}  // namespace hqslam::test

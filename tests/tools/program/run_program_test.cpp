#include "golden_folder.h"
#include "hqslam/core/cloud_file.h"
#include "hqslam/evaluation/trajectory_error.h"
#include "hqslam/nn/instruction_set.h"
#include "tools/page_data.h"
#include "tools/program/child.h"

namespace hqslam::test {

TEST_CASE("a sensor upside down is followed once it is known; a user who does not say is asked") {
  const TemporaryDirectory folder;
  const std::string drive = folder.file("drive");
  succeeds("simulate --drive block --sensor os1-16 --scans 12 --mount 180,4 --out '{}'", drive);
  const std::string run = fmt::format("run '{}' --out '{}'", drive, folder.file("results"));
  const std::string question = "the sensor may lean or hang upside down";
  CHECK(holds(run_hqslam(run).out, question));
  CHECK(holds(run_hqslam("info '{}'", drive).out, question));
  CHECK(holds(run_hqslam("run '{}/scans.npy' --sensor os1-16 --row-order lowest-first --out '{}'",
                         simulated_drive("--sensor os1-16 --scans 12"), folder.file("reversed"))
                  .out,
              "in reverse order"));

  const ProgramResult known =
      succeeds(run + " --set mounting.roll_rad=3.14159265 --set mounting.pitch_rad=0.0698");
  CHECK(holds(known.out, "mounting: roll 180.0, pitch 4.0 degrees\n"));
  CHECK_FALSE(holds(known.out, question));
  CHECK(end_error_m(folder.file("results"), drive) < 0.03);

  const ProgramResult estimated =
      run_hqslam(run + " --set mounting.roll_rad=3.14159265 --set mounting.estimated=1");
  CHECK(holds(estimated.out, " degrees, estimated from the ground\n"));
}

TEST_CASE("a simulated drive needs no sensor and no reference: both are in its folder") {
  const TemporaryDirectory out;
  const ProgramResult result = succeeds("run '{}' --out '{}'", simulated_drive(), out.path());
  CHECK(missing(result.out, {"APE RMSE", "alignment: se3"}) == "");
  const nlohmann::json timings = json_of(out.file("timings.json"));
  const auto located = timings["mapping_status"]["ok"].get<int>();
  CHECK(located > kDriveScans / 2);
  CHECK(holds(result.out, fmt::format("mapping: {} scans ok", located)));
  const Trajectory found = read_tum(out.file("trajectory.tum"));
  REQUIRE(found.size() == kDriveScans);
  CHECK(read_kitti_poses(out.file("trajectory.kitti")).size() == kDriveScans);
  CHECK(found.front().T_map_sensor.isApprox(Pose::Identity()));
  const Scan map = read_cloud(out.file("map.pcd"));
  CHECK(map.points_m.size() > 1000);
  CHECK(map.intensity.size() == map.points_m.size());
  CHECK(timings["end"] == "complete");
  const Trajectory truth = read_tum(simulated_drive() + "/truth.tum");
  CHECK(absolute_pose_error(found, truth, Alignment::kFirstPose).translation_statistics.max < 0.2);
}

TEST_CASE("a recording of which nothing can be used leaves the results of an earlier run") {
  const TemporaryDirectory folder;
  const std::string arguments =
      fmt::format("run '{0}/bin' --sensor os1-16 --out '{0}/out'", folder.path());
  fs::copy(simulated_drive() + "/bin", folder.file("bin"));
  succeeds(arguments);
  const std::string before = file_contents(folder.file("out/trajectory.tum"));
  for (const fs::path& file : fs::directory_iterator(folder.file("bin"))) {
    fs::resize_file(file, 1001);
  }
  CHECK(holds(last_line(refused(arguments)), ".bin"));
  CHECK(file_contents(folder.file("out/trajectory.tum")) == before);
  CHECK(fs::exists(folder.file("out/report.html")));
}

TEST_CASE("LeGO-LOAM follows a drive of 16 rows and of 64 upsampled ones, and says what it lacks") {
  const TemporaryDirectory folder;
  const Trajectory truth = read_tum(simulated_drive() + "/truth.tum");
  const std::string weights = golden_folder() + "/../../weights/du-mix_any-beams.npz";
  for (const std::string& upsampling : {std::string(), "--upsample '" + weights + "'"}) {
    CAPTURE(upsampling);
    const ProgramResult result = succeeds("run '{}' --slam lego-loam {} --out '{}'",
                                          simulated_drive(), upsampling, folder.file("out"));
    CHECK_FALSE(holds(result.out + result.error, "loop"));  // it closes none
    const Pose motion = truth.front().T_map_sensor.inverse() * truth.back().T_map_sensor;
    CHECK(end_error_m(folder.file("out"), simulated_drive()) < 0.1 * motion.translation().norm());
  }
  for (const char* option : {"--save-map", "--set mapping.max_iterations=12"}) {
    CHECK(holds(refused("run '{}' --slam lego-loam {} --out '{}'", simulated_drive(), option,
                        folder.file("out")),
                "--slam lego-loam"));
  }
}

TEST_CASE("Ctrl-C stops a run with status 130 and valid results") {
  const TemporaryDirectory folder;
  const std::string input = folder.file("bin");
  fs::create_directory(input);
  for (int i = 0; i < 5000; ++i) {  // the drive's first two scans in turn
    fs::create_symlink(fmt::format("{}/bin/{:06}.bin", simulated_drive(), i % 2),
                       fmt::format("{}/{:06}.bin", input, i));
  }
  const std::string out = folder.file("out");
  Child child(fmt::format("run '{}' --sensor os1-16 --out '{}'", input, out));
  CHECK(child.wait_for(out + "/trajectory.tum"));
  CHECK(child.end(SIGINT) == 130);
  const std::size_t poses = read_tum(out + "/trajectory.tum").size();
  CHECK(poses >= 1);
  CHECK(poses < 5000);
  CHECK(read_kitti_poses(out + "/trajectory.kitti").size() == poses);
  CHECK(fs::exists(out + "/report.html"));
  CHECK(fs::exists(out + "/map.pcd"));
}

TEST_CASE("help and version are no errors, other commands and paths are") {
  CHECK(run_hqslam("--version").out.rfind("hqslam ", 0) == 0);
  for (const char* arguments : {"--help", "run --help", "evaluate --help", "--version"}) {
    CHECK(succeeds(arguments).error.empty());
  }
  for (const char* arguments : {"fly", "", "run /no/such/folder --sensor os1-16 --out x"}) {
    refused(arguments);
    CHECK(run_hqslam(arguments).out.empty());
  }
}

TEST_CASE("the demo ends with a table of every way through the drive and a report for each") {
  const TemporaryDirectory folder;
  const ProgramResult result = succeeds("demo --out '" + folder.path() + "'");
  std::vector<std::pair<std::string, std::string>> ways = {
      {"64 beams", "rows-64"}, {"16 beams", "rows-16"}, {"16 -> 64, linear", "linear"}};
  if (!holds(result.out, "Without DU-Mix")) ways.emplace_back("16 -> 64, DU-Mix", "du-mix");
  const nlohmann::json page = data_of(file_contents(folder.file("demo.html")));
  std::size_t row = 0;
  for (const auto& [way, results] : ways) {
    const std::string& name = way;
    CAPTURE(name);
    CHECK(holds(result.out, fmt::format("\n{:<16}{:>7}", name, 200)));
    const std::string report = results + "/report.html";
    CHECK(holds(result.out, report));
    CHECK(fs::exists(folder.file(report)));
    CHECK(page["table"]["links"][row++] == report);
  }
  CHECK(page["table"]["columns"][2] == "APE, m");
  CHECK(holds(page["notes"][0].get<std::string>(), "APE: absolute pose error"));
  CHECK(page["images"].size() == ways.size());
}

TEST_CASE("run --scans uses these scans alone, with their own stamps and their own truth") {
  const TemporaryDirectory folder;
  const auto run = [&](const std::string& options) {
    return fmt::format("run '{}' {} --out '{}'", simulated_drive(), options, folder.file("out"));
  };
  CHECK(holds(succeeds(run("--scans 1..2")).out, "2 scans, "));
  const Trajectory part = read_tum(folder.file("out/trajectory.tum"));
  REQUIRE(part.size() == 2);
  succeeds(run("--scans 1.."));
  const Trajectory rest = read_tum(folder.file("out/trajectory.tum"));
  REQUIRE(rest.size() == kDriveScans - 1);
  CHECK(rest[0].stamp_s == part[0].stamp_s);
  succeeds(run(""));
  CHECK(read_tum(folder.file("out/trajectory.tum"))[1].stamp_s == rest[0].stamp_s);
  for (const char* wrong : {"2..1", "a..b", "1", "..-1", "9999.."}) {
    refused(run(std::string("--scans ") + wrong));
  }
}

TEST_CASE("run begins anew without parts of the vehicle that hide half of the view") {
  const TemporaryDirectory folder;
  const std::string drive = simulated_drive("--sensor os1-16 --scans 110");
  NpyStackReader reader(drive + "/scans.npy");
  NpyStackWriter writer(folder.file("cab.npy"), 16, 1024);
  for (std::int64_t i = 0; i < reader.images(); ++i) {
    RangeImage image = reader.read(i);
    for (int row = 0; row < 16; ++row) std::fill_n(&image.at(row, 0), 512, 1.2F);
    writer.append(image);
  }
  const ProgramResult result = succeeds("run '{}' --sensor '{}' --out '{}'", folder.file("cab.npy"),
                                        drive + "/sensor.json", folder.file("out"));
  CHECK(holds(result.error, "parts of the vehicle hide 50 % of the view; the run begins anew"));
  CHECK(holds(result.out, "110 scans"));
  CHECK(holds(result.out, "8192 of 16384 pixels, 1.2 to 1.2 m away; left out"));
  CHECK(end_error_m(folder.file("out"), drive) < 0.3);
}

TEST_CASE("--upsample without a value takes du-mix weights of the sensor") {
  const TemporaryDirectory folder;
  const std::string drive = simulated_drive("--sensor os1-16 --scans 3");
  succeeds("run '{}' --upsample du-mix --out '{}'", drive, folder.file("named"));
  const ProgramResult bare = succeeds("run '{}' --upsample --out '{}'", drive, folder.file("bare"));
  CHECK(holds(bare.out, "upsampled to 64 rows by "));
  CHECK(file_contents(folder.file("bare") + "/trajectory.tum") ==
        file_contents(folder.file("named") + "/trajectory.tum"));
  CHECK(run_hqslam("run --upsample '{}' --out '{}'", drive, folder.file("none")).status == 2);
}

}  // namespace hqslam::test

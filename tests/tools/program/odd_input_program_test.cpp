#include "tools/program/arguments.h"
#include "tools/program/untrained_weights.h"

// Input that users hand over by mistake: results among the input, contents that steer a
// terminal, impossible paths, files that are no recipes, names, numbers and locales of all kinds.

namespace hqslam::test {
TEST_CASE("no command writes among the scans, also where they are in a folder below as KITTI's") {
  const TemporaryDirectory folder;
  fs::copy(simulated_drive() + "/bin", folder.file("velodyne"));
  fs::create_directory_symlink(folder.file("velodyne"), folder.file("velodyne/link"));
  const std::string upsampled = "upsample '{0}' --sensor os1-64 --method linear --out '{0}/{1}'";
  const std::string mapped = "map '{0}' --sensor os1-16 --poses '{2}/truth.kitti' --out '{0}/{1}'";
  for (const std::string& given :
       {std::string("run '{0}' --sensor os1-16 --out '{0}/{1}'"), upsampled, mapped}) {
    for (const char* out : {".", "velodyne", "velodyne/link", "velodyne/../velodyne"}) {
      CHECK(holds(refused(fmt::format(fmt::runtime(given), folder.path(), out, simulated_drive())),
                  "holds the recording"));
    }
  }
  CHECK(std::distance(fs::directory_iterator(folder.file("velodyne")), {}) == kDriveScans + 1);
  CHECK(std::distance(fs::directory_iterator(folder.path()), {}) == 1);
}

TEST_CASE("options that would do nothing, or cannot be, are refused with what they need") {
  const TemporaryDirectory out;
  const std::string input =
      fmt::format("'{0}/pcd' --sensor os1-16 --out '{1}/x' ", simulated_drive(), out.path());
  for (const auto& [options, needs] :
       {std::pair("--confidence 0.5", "--upsample"), std::pair("--tolerance 0.1", "--upsample"),
        std::pair("--spacing 0.5", "--upsample"), std::pair("--map-voxel 0.2", "--dense-map"),
        std::pair("--stamps ''", "expected a file or 'names', found nothing"),
        std::pair("--slam lego-loam --imu '/dev/null'", "leave --imu out"),
        std::pair("--occupancy-grid --grid-band 2,0.25", "expected LOW,HIGH"),
        std::pair("--occupancy-grid --grid-band 0,2", "lowest_obstacle_m is 0,"),
        std::pair("--occupancy-grid --grid-band nan,2", "lowest_obstacle_m is nan"),
        std::pair("--occupancy-grid --grid-band 1", "--grid-band"),
        std::pair("--stream /points", "leave --stream out")}) {
    CAPTURE(options);
    CHECK(holds(refused("run " + input + options), needs));
  }
  CHECK_FALSE(fs::exists(out.file("x")));
  std::vector<std::pair<std::string, const char*>> refusals = {
      {"info '{0}' --stream 7502", "leave --stream out"},
      {"upsample '{0}' --sensor os1-64 --method linear --poses '{0}/truth.tum' --out '{1}'",
       "weights with a memory"},
      {"evaluate '{0}/truth.tum' '{0}/truth.tum' --sensor os1-16", "two .npy stacks"},
      {"inspect '{0}' --slam --tensor mode_1 --out '{1}'", "--slam excludes"},
      {"inspect '{0}' --slam --reference --out '{1}'", "--slam excludes"}};
  for (const std::string command :
       {"run '{0}' --out '{1}'", "upsample '{0}' --method linear --out '{1}'", "compare '{0}'",
        "table --drives '{0}' --methods rows-16 --out '{1}'",
        "map '{0}' --poses '{0}/truth.tum' --out '{1}'", "calibrate '{0}' --out '{1}.json'"}) {
    refusals.emplace_back(command + " --capture corrected --stream 7502",
                          "--stream does not apply to a stack of range images");
  }
  for (const auto& [given, says] : refusals) {
    CHECK(holds(refused(fmt::format(fmt::runtime(given), simulated_drive(), out.file("y"))), says));
  }
}

TEST_CASE("names and contents of files do not steer the terminal, and stay in one line") {
  const TemporaryDirectory folder;
  const std::string pcd =
      "# .PCD v0.7\nVERSION 0.7\nFIELDS \x1b[31mred " + std::string(100000, 'a') +
      " z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1\nHEIGHT 1\nPOINTS 1\nDATA ascii\n1 2 3\n";
  const std::string name = folder.file("a\n\x1b[2Jb.pcd");
  write_file(name, pcd);
  const ProgramResult result =
      run_hqslam("run '{}' --sensor os1-16 --out '{}' 2>&1 >/dev/null | tail -1 >&2", name,
                 folder.file("out"));
  CHECK(is_one_line(result.error));
  CHECK(result.error.size() < 6000);
  CHECK_FALSE(holds(result.error, "\x1b"));
  CHECK(missing(result.error, {"\\x1b[31mred", "a\\n\\x1b[2Jb.pcd"}) == "");
}

TEST_CASE("a path that cannot be is wrong input") {
  const std::string long_name(300, 'a');
  const TemporaryDirectory folder;
  for (const std::string& out : {long_name, std::string("/dev/null/x"), std::string("/proc/x/y")}) {
    for (const std::string& arguments :
         {simulate_arguments(out), upsample_arguments(out), run_arguments(out),
          "table --drives block --methods rows-16 --scans 3 --out '" + out + "'",
          train_arguments(folder, out), "live --sensor vlp-16 --port 47813 --out '" + out + "'",
          "demo --out '" + out + "'"}) {
      CAPTURE(arguments);
      CHECK(holds(refusal(run_hqslam(arguments)), out));
    }
  }
}

#ifdef __SANITIZE_ADDRESS__  // which reserves twenty terabytes of addresses
constexpr const char* kLittleMemory = "";
#else
constexpr const char* kLittleMemory = "ulimit -v 1000000;";
#endif

TEST_CASE("a recipe that is no file, or no text, is refused without being read") {
  const TemporaryDirectory folder;
  write_file(folder.file("large.json"), "{");
  fs::resize_file(folder.file("large.json"), std::uintmax_t{3} << 30U);
  for (const std::string& recipe :
       {std::string("/dev/zero"), folder.file("large.json"), folder.path()}) {
    const ProgramResult result = run_shell(fmt::format(
        "{} exec {}", kLittleMemory,
        command_line(fmt::format("train --config '{}' --out '{}'", recipe, folder.file("out")))));
    CHECK(holds(refusal(result), recipe + ": expected a training configuration (.json)"));
  }
}

TEST_CASE("more threads than any machine has are not started") {
  const TemporaryDirectory folder;
  CHECK(run_shell("OMP_NUM_THREADS=100000 " + command_line(run_arguments(folder.file("out"))))
            .status == 0);
  run_hqslam(run_arguments(folder.file("usual")));
  CHECK(file_contents(folder.file("out/trajectory.tum")) ==
        file_contents(folder.file("usual/trajectory.tum")));
}

TEST_CASE("paths with blanks, quotes and letters of all kinds do, and a comma locale") {
  const TemporaryDirectory folder;
  const fs::path place = folder.file("Meine Fahrten über Größe \"eins\" 東京");
  fs::create_directory(place);
  fs::copy(short_drive(), place / "die Fahrt", fs::copy_options::recursive);
  const std::string locales = folder.file("locales");
  fs::create_directory(locales);
  const bool comma =
      run_shell("localedef -i de_DE -f UTF-8 '" + locales + "/de_DE.UTF-8'").status == 0;
  if (!comma) MESSAGE("SKIPPED: a comma locale (there is no localedef)");
  const std::string environment =
      comma ? fmt::format("LOCPATH='{}' LC_ALL=de_DE.UTF-8 LANG=de_DE.UTF-8 ", locales) : "";
  const auto in_place = [&](const std::string& arguments) {
    return run_shell("cd '" + place.string() + "'; " + environment + command_line(arguments));
  };
  REQUIRE(in_place("run 'die Fahrt' --out 'das Ergebnis: ä'").status == 0);
  succeeds(run_arguments(folder.file("usual")));
  for (const char* name : {"trajectory.tum", "trajectory.kitti", "map.pcd"}) {
    CHECK(file_contents((place / "das Ergebnis: ä" / name).string()) ==
          file_contents(folder.file(std::string("usual/") + name)));
  }
  CHECK(in_place("upsample 'die Fahrt/pcd' --method linear --sensor os1-64 --out 'höher'").status ==
        0);
  CHECK(in_place("run höher --out 'noch ein Ergebnis'").status == 0);
  CHECK(holds(in_place("run 'kein Ördner' --sensor os1-16 --out x").error, "kein Ördner"));
}

TEST_CASE("mistyped subcommands, options and sensors have the nearest names") {
  CHECK(holds(run_hqslam("rum").error, "did you mean 'run'?"));
  CHECK(holds(run_hqslam("info / --sensr vlp-16").error, "did you mean '--sensor'?"));
  CHECK(holds(run_hqslam("info / --sensr vlp-16").error, "found unexpected '--sensr vlp-16'"));
  CHECK(holds(run_hqslam("info / --sensor vpl-16").error, "did you mean 'vlp-16'?"));
  CHECK_FALSE(holds(run_hqslam("entirely-else").error, "did you mean"));
}

}  // namespace hqslam::test

#include "hqslam/core/point_fields.h"
#include "hqslam/recordings/recording.h"
#include "tools/program/program.h"
#include "tools/program/untrained_weights.h"

namespace hqslam::test {
namespace {

constexpr int kScans = 4;

/// A drive of an OS1-64, a stack of its measured rows alone, and weights for them.
struct Material {
  TemporaryDirectory folder;
  std::string drive = simulated_drive("--sensor os1-64 --scans " + std::to_string(kScans));
  std::string measured = folder.file("measured.npy");
  std::string weights = untrained_file();
  Material() {
    NpyStackReader all(drive + "/scans.npy");
    NpyStackWriter rows(measured, 16, 1024);
    for (std::int64_t i = 0; i < all.images(); ++i) {
      rows.append(select_rows(all.read(i), selection_for(64, 16)));
    }
  }
};

const Material& files() {
  static const Material made;
  return made;
}

}  // namespace

TEST_CASE("a stack of 16 rows and one of 64 of which 16 are measured give the same stack") {
  for (const std::string& method :
       {"--weights '" + files().weights + "'", std::string("--method inverse --sensor os1-64")}) {
    CAPTURE(method);
    std::vector<std::string> stacks;
    for (const std::string& input :
         {files().measured, files().drive + "/scans.npy", files().drive}) {
      const TemporaryDirectory out;
      CHECK(missing(succeeds("upsample '{}' {} --out '{}'", input, method, out.path()).out,
                    {"4 scans, 16 rows -> 64 rows of 1024 columns", "scans/s"}) == "");
      stacks.push_back(file_contents(out.file("scans.npy")));
    }
    CHECK(stacks[0].size() == 128U + std::size_t{4} * kScans * 64 * 1024);
    CHECK(stacks[0] == stacks[1]);
    CHECK(stacks[0] == stacks[2]);
    const TemporaryDirectory out;
    succeeds("upsample '{}' {} --scans 2.. --out '{}'", files().drive, method, out.path());
    const std::string last = file_contents(out.file("scans.npy"));
    CHECK(last.substr(128) == stacks[0].substr(128 + std::size_t{4} * 2 * 64 * 1024));
  }
}

TEST_CASE("upsampling and then running is running with --upsample") {
  for (const std::string& method : {files().weights, std::string("linear")}) {
    CAPTURE(method);
    const TemporaryDirectory folder;
    const bool network = method == files().weights;
    succeeds("upsample '{}' {} '{}' --out '{}'", files().drive, network ? "--weights" : "--method",
             method, folder.file("drive"));
    CHECK(holds(succeeds("run '{}' --out '{}'", folder.file("drive"), folder.file("two_steps")).out,
                "APE RMSE"));
    succeeds("run '{}' --upsample '{}' --out '{}'", files().drive, method, folder.file("one_step"));
    for (const char* result : {"trajectory.tum", "map.pcd"}) {
      CHECK(file_contents(folder.file("one_step/") + result) ==
            file_contents(folder.file("two_steps/") + result));
    }
    const nlohmann::json timings = json_of(folder.file("one_step/timings.json"));
    CHECK(timings["rows"] == 64);
    CHECK(timings["upsampled_by"] == (network ? "du-or" : "linear"));
    CHECK(timings["times_ms"]["upsampling"]["median"] > 0.0);
    CHECK(timings["per_scan"]["times_ms"]["upsampling"].size() == kScans);
    CHECK(holds(file_contents(folder.file("one_step/report.html")), "upsampling"));
  }
}

TEST_CASE("a calibration corrects ranges once; computed rows have corrections in between") {
  const TemporaryDirectory folder;
  SensorModel sensor = sensor_preset("os1-64");
  sensor.elevation_correction_rad.assign(64, 0.0);
  sensor.range_correction_m.assign(64, 0.1);
  sensor.elevation_correction_rad[7] = 0.004;  // of the measured rows 3, 7, 11, ...
  sensor.elevation_correction_rad[8] = 0.04;   // of one that is not
  const std::string calibrated = folder.file("calibrated.json");
  write_sensor_json(sensor, calibrated);
  const std::string stack = files().drive + "/scans.npy";
  succeeds("upsample '{}' --sensor '{}' --method linear --out '{}'", stack, calibrated,
           folder.file("upsampled"));
  const RangeImage recorded = NpyStackReader(stack).read(0);
  const RangeImage image = NpyStackReader(folder.file("upsampled/scans.npy")).read(0);
  for (int column = 0; column < recorded.columns; ++column) {
    if (recorded.at(31, column) <= 0.0F) continue;
    CHECK(image.at(31, column) == doctest::Approx(recorded.at(31, column) + 0.1F));
  }
  const SensorModel upsampled = read_sensor_json(folder.file("upsampled/sensor.json"));
  CHECK(upsampled.range_correction_m == std::vector<double>(64, 0.0));
  CHECK(upsampled.elevation_correction_rad[7] == doctest::Approx(0.004));
  CHECK(upsampled.elevation_correction_rad[8] == doctest::Approx(0.003));
  CHECK(upsampled.elevation_correction_rad[11] == 0.0);

  const ProgramResult as_recorded = succeeds("compare '{}' --sensor os1-64", stack);
  CHECK(as_recorded.out != succeeds("compare '{}' --sensor '{}'", stack, calibrated).out);
}

TEST_CASE("where the poses are known a network with a memory recalls the scans around each") {
  const TemporaryDirectory folder;
  const std::string weights = untrained_file("du-mix", "scan_memory");
  const auto upsampled = [&](const std::string& poses, const std::string& out) {
    const std::string error = succeeds("upsample '{}' --weights '{}' {} --confidence 0 --out '{}'",
                                       files().drive, weights, poses, folder.file(out))
                                  .error;
    CHECK(holds(error, "recalls no earlier scan without poses") == poses.empty());
    return folder.file(out + "/scans.npy");
  };
  NpyStackReader without(upsampled("", "without"));
  NpyStackReader with(upsampled("--poses '" + files().drive + "/truth.tum'", "with"));
  REQUIRE(with.images() == without.images());
  for (int scan = 0; scan < 3; ++scan) {  // the first too, by later ones; the car stands
    CHECK(with.read(scan).range_m != without.read(scan).range_m);
  }

  succeeds("compare '{0}' --weights '{1}' --poses '{0}/truth.tum' --json '{2}'", files().drive,
           weights, folder.file("with.json"));
  succeeds("compare '{}' --weights '{}' --json '{}'", files().drive, weights,
           folder.file("without.json"));
  const auto f1 = [&](const char* file, std::size_t method) {
    return json_of(folder.file(file))["methods"][method]["f1"].get<double>();
  };
  succeeds("compare '{0}' --weights '{1}' --poses '{0}/truth.tum' --no-look-ahead --json '{2}'",
           files().drive, weights, folder.file("before.json"));
  CHECK(f1("with.json", 1) == f1("without.json", 1));  // linear
  CHECK(f1("before.json", 3) != f1("with.json", 3));
  CHECK(f1("with.json", 3) != f1("without.json", 3));

  const auto page_of = [&](int scan) {
    succeeds("inspect '{0}' --weights '{1}' --poses '{0}/truth.tum' --scan {2} --out '{3}'",
             files().drive, weights, scan, folder.file("page.html"));
    return file_contents(folder.file("page.html"));
  };
  for (const int scan : {0, 2}) CHECK(holds(page_of(scan), R"("what":"recalled")"));
  CHECK(holds(page_of(2), R"("what":"memory_change")"));

  // Poses that some scans lack are not left aside without a word.
  Trajectory truth = read_tum(files().drive + "/truth.tum");
  for (StampedPose& pose : truth) pose.stamp_s += 0.1;
  write_tum(truth, folder.file("shifted.tum"));
  const ProgramResult some =
      succeeds("upsample '{}' --weights '{}' --poses '{}' --out '{}'", files().drive, weights,
               folder.file("shifted.tum"), folder.file("some"));
  CHECK(holds(some.error, "1 of 4 scans have no pose"));

  // SLAM's own poses, those that it expects and then those that it finds.
  const ProgramResult run = succeeds("run '{}' --upsample '{}' --dense-map --out '{}'",
                                     files().drive, weights, folder.file("run"));
  CHECK(holds(run.out, "APE RMSE"));
  CHECK(fs::exists(folder.file("run/dense_map.ply")));
}

TEST_CASE("an upsampled recording states whether its scans were corrected for motion") {
  for (const auto& [part, corrected] : {std::pair("scans.npy", false), std::pair("bin", true)}) {
    CAPTURE(part);
    const TemporaryDirectory out;
    succeeds("upsample '{}/{}' --sensor os1-64 --method linear --out '{}'", files().drive, part,
             out.path());
    CHECK(read_sensor_json(out.file("sensor.json")).motion_corrected == corrected);
  }
}

}  // namespace hqslam::test

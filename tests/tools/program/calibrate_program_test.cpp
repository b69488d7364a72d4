#include "made_images.h"
#include "tools/program/program.h"

// What calibrate writes, and that other commands take it.
namespace hqslam::test {
namespace {

/// Scans of a sensor with few columns whose beams have errors; 75 are some 30 m of street.
struct LyingDrive {
  TemporaryDirectory folder;
  std::string drive = folder.file("drive");
  std::string sensor = folder.file("calibrated.json");

  explicit LyingDrive(int scans = 75, const std::string& errors = "bad") {
    write_sensor_json(preset_with("os1-16", 512), folder.file("sensor.json"));
    succeeds("simulate --drive block --sensor '{}' --scans {} --sensor-errors {} --out '{}'",
             folder.file("sensor.json"), scans, errors, drive);
  }
  std::string arguments(const std::string& out) const {
    return fmt::format("calibrate '{}' --out '{}'", drive, out);
  }
};

}  // namespace

TEST_CASE("calibrate writes a sensor that run takes, and a page of what it found") {
  const LyingDrive lying;
  CHECK(holds(succeeds(lying.arguments(lying.sensor)).out, "off their surfaces"));
  CHECK(holds(file_contents(lying.folder.file("calibrated.html")), "ground_mm"));
  const SensorModel sensor = read_sensor_json(lying.sensor);
  REQUIRE(sensor.elevation_correction_rad.size() == 16);
  CHECK(sensor.beam_elevation_rad ==
        read_sensor_json(lying.folder.file("sensor.json")).beam_elevation_rad);
  const std::string run = lying.folder.file("run");
  succeeds("run '{}' --sensor '{}' --out '{}'", lying.drive, lying.sensor, run);
  CHECK(file_contents(run + "/trajectory.tum").size() > 0);
  succeeds(lying.arguments(lying.sensor));  // its own it replaces
}

TEST_CASE("calibrate uses only the scans before tracking was lost, and says so") {
  const LyingDrive lying;
  const std::string blind = lying.folder.file("blind.npy");
  NpyStackReader reader(lying.drive + "/scans.npy");
  NpyStackWriter writer(blind, 16, 512);
  for (std::int64_t i = 0; i < reader.images(); ++i) {
    RangeImage image = i >= 52 && i < 72 ? RangeImage(16, 512) : reader.read(i);
    for (int row = 0; row < 16 && i >= 72; ++row) {  // elsewhere: as in a mirror
      std::reverse(&image.at(row, 0), &image.at(row, 0) + 512);
    }
    writer.append(image);
  }
  const ProgramResult result = succeeds("calibrate '{}' --sensor '{}' --out '{}'", blind,
                                        lying.folder.file("sensor.json"), lying.sensor);
  CHECK(holds(last_line(result.error), "blind.npy: tracking was lost after 2"));
  CHECK(holds(result.out, "off their surfaces"));
}

TEST_CASE("calibrate asks for a drive of measured scans") {
  const LyingDrive standing(3);
  const auto refusal_of = [&](const std::string& drive) {
    return refusal(
        run_hqslam("calibrate '{}' --out '{}'", drive, standing.folder.file("none.json")));
  };
  CHECK(holds(refusal_of(standing.drive), "expected at least 20 m"));
  const std::string upsampled = standing.folder.file("upsampled");
  succeeds("upsample '{}' --sensor os1-64 --method linear --out '{}'",
           simulated_drive("--sensor os1-16 --scans 3"), upsampled);
  CHECK(holds(refusal_of(upsampled), "found computed ones"));
}

TEST_CASE("run corrects beams as calibrate does, unless it is not to or they have no errors") {
  const LyingDrive lying(160);
  const auto result = succeeds("run '{}' --out '{}'", lying.drive, lying.folder.file("run"));
  CHECK(holds(result.error, "begins anew"));
  CHECK(holds(result.out, "with corrected beams; corrected"));
  const std::string corrected = lying.folder.file("run") + "/corrected_sensor.json";
  succeeds(lying.arguments(lying.sensor));
  CHECK(file_contents(corrected) == file_contents(lying.sensor));
  const auto begins_anew = [&](const std::string& options) {
    const ProgramResult other =
        succeeds("run '{}' {} --out '{}'", lying.drive, options, lying.folder.file("other"));
    return holds(other.error, "begins anew") ||
           !file_contents(lying.folder.file("other") + "/corrected_sensor.json").empty();
  };
  CHECK_FALSE(begins_anew(fmt::format("--sensor '{}'", corrected)));  // no errors are left
  CHECK_FALSE(begins_anew("--no-calibration"));
  const LyingDrive honest(160, "none");
  const auto kept = succeeds("run '{}' --out '{}'", honest.drive, honest.folder.file("run"));
  CHECK_FALSE(holds(kept.error, "begins anew"));
  CHECK_FALSE(holds(kept.out, "beams:"));
  CHECK_FALSE(holds(succeeds("info '{}'", honest.drive).out, "hqslam run corrects them"));
  CHECK(holds(succeeds(honest.arguments(honest.sensor)).error, "not significant"));
  CHECK_FALSE(holds(succeeds(lying.arguments(lying.sensor)).error, "not significant"));
  CHECK(holds(succeeds("info '{}'", lying.drive).out, "hqslam run corrects them"));
}

}  // namespace hqslam::test

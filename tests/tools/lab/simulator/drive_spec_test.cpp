#include "hqslam/sim/drive.h"
#include "hqslam/sim/write_drive.h"
#include "small_city.h"

using namespace hqslam::sim;

namespace {

DriveSpec block_with_seed(std::uint64_t seed) { return {"block", seed, 2, {}, {}}; }

}  // namespace

TEST_CASE("conditions are drawn from the seed, within their bounds, and differ between seeds") {
  int clear = 0;
  double lowest_m = 10.0;
  double highest_m = 0.0;
  double steepest_rad = 0.0;
  constexpr int kSeeds = 400;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const DriveSpec spec = with_varied_conditions(block_with_seed(seed));
    CHECK(spec.mount == with_varied_conditions(block_with_seed(seed)).mount);
    CHECK_NOTHROW(validate(spec));
    lowest_m = std::min(lowest_m, spec.mount.sensor_height_m);
    highest_m = std::max(highest_m, spec.mount.sensor_height_m);
    steepest_rad = std::max(
        {steepest_rad, std::abs(spec.mount.mount_roll_rad), std::abs(spec.mount.mount_pitch_rad)});
    CHECK(spec.conditions.extra_range_noise_m <= 0.02);
    CHECK(spec.conditions.dropout_share <= 0.06);
    CHECK(spec.conditions.extinction_per_m <= 0.03);
    CHECK(spec.conditions.airborne_share <= 0.02);
    clear += spec.conditions.extinction_per_m == 0.0 ? 1 : 0;
  }
  CHECK(lowest_m >= 0.4);
  CHECK(lowest_m < 0.45);
  CHECK(highest_m <= 2.2);
  CHECK(highest_m > 2.15);
  CHECK(steepest_rad <= 0.0873);
  CHECK(steepest_rad > 0.06);
  CHECK(clear == doctest::Approx(0.75 * kSeeds).epsilon(0.1));
}

TEST_CASE("mounts and conditions that cannot be are named with field and bounds") {
  const auto message = [](auto change) {
    DriveSpec spec = block_with_seed(1);
    change(spec);
    return error_message([&] { DriveSimulator(spec, small_sensor()); });
  };
  const std::vector<std::pair<void (*)(DriveSpec&), std::string>> cases = {
      {[](DriveSpec& s) { s.mount.sensor_height_m = 0.0; }, "sensor_height_m is 0"},
      {[](DriveSpec& s) { s.mount.mount_roll_rad = std::nan(""); }, "mount_roll_rad is nan"},
      {[](DriveSpec& s) { s.mount.mount_pitch_rad = -1.0; }, "mount_pitch_rad is -1"},
      {[](DriveSpec& s) { s.conditions.dropout_share = 1.0; }, "dropout_share is 1"},
      {[](DriveSpec& s) { s.conditions.extra_range_noise_m = -0.1; }, "extra_range_noise_m"},
      {[](DriveSpec& s) { s.conditions.extinction_per_m = 2.0; }, "extinction_per_m"},
      {[](DriveSpec& s) { s.conditions.airborne_share = -1.0; }, "airborne_share"},
  };
  for (const auto& [change, named] : cases) {
    CHECK(one_line_with(message(change), "block", named, "expected", "; give "));
  }
  CHECK(one_line_with(message(cases.front().first), "0.1 to 10; give "));
}

TEST_CASE("a drive is read as it was written, with its mount and conditions") {
  for (const bool varied : {false, true}) {
    const TemporaryDirectory folder;
    DriveSpec spec{"town", 0xFFFFFFFFFFFFFFFFU, 12, {}, {}};
    if (varied) spec = with_varied_conditions(spec);
    { const DriveWriter writer(folder.path(), spec, small_sensor()); }
    CHECK(read_drive_json(folder.file("drive.json")) == spec);
  }
}

TEST_CASE("what is no drive.json, or of another revision, is one line that names the file") {
  const auto refuses = [](const std::string& json, const auto&... parts) {
    CHECK(refused_with([&] { from_file("drive.json", json, read_drive_json); }, parts...));
  };
  CHECK(refused_with([] { read_drive_json("/no/drive.json"); }, "drive.json", "found no file"));
  refuses("not json", "drive.json", "JSON");
  refuses("[]", "drive.json", "object");
  refuses(R"({"name": "town", "seed": 1})", "drive.json", "scans");
  refuses(R"({"name": "town", "seed": -1, "scans": 3})", "drive.json", "seed");
  refuses(R"({"name": "town", "seed": 1, "scans": 0})", "scans");
  refuses(R"({"name": "moon", "seed": 1, "scans": 3})", "moon");
  refuses(R"({"name": "town", "seed": 1, "scans": 3, "mount": 4})", "drive.json", "mount");
  refuses(std::string(100000, ' '), "drive.json", "bytes");
  refuses(R"({"name": "town", "seed": 7, "revision": 1, "scans": 5})", "revision 1, expected");
}

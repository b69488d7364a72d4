#include "hqslam/sim/drive.h"

#include "hash.h"
#include "slam/poses.h"
#include "small_city.h"

using namespace hqslam::sim;

namespace {

std::vector<SimulatedScan> drive(const DriveSpec& spec) {
  DriveSimulator simulator(spec, small_sensor());
  std::vector<SimulatedScan> scans;
  while (auto scan = simulator.next()) scans.push_back(*scan);
  return scans;
}

DriveSpec short_drive(const char* name, std::int64_t scans) {
  DriveSpec spec = drive_preset(name);
  spec.scans = scans;
  return spec;
}

std::uint64_t hash_of_scan(const DriveSpec& spec, std::int64_t scan) {
  DriveSimulator simulator(spec, small_sensor());
  simulator.skip(scan);
  std::vector<std::uint32_t> ranges_mm;
  const RangeImage image = simulator.next()->image;
  for (const float range_m : image.range_m) {
    ranges_mm.push_back(static_cast<std::uint32_t>(std::lround(1000.0 * range_m)));
  }
  return hash_of(ranges_mm);
}

}  // namespace

TEST_CASE("a simulated sensor is as it was made, whatever a calibration said of it") {
  SensorModel sensor = small_sensor();
  sensor.elevation_correction_rad.assign(sensor.beam_elevation_rad.size(), 0.005);
  sensor.range_correction_m.assign(sensor.beam_elevation_rad.size(), 0.2);
  sensor.motion_corrected = true;
  CHECK(DriveSimulator(short_drive("block", 1), sensor).sensor() == small_sensor());
}

TEST_CASE("a shorter drive is the beginning of a longer one") {
  const auto shorter = drive(short_drive("town", 3));
  const auto longer = drive(short_drive("town", 6));
  for (std::size_t k = 0; k < shorter.size(); ++k) {
    CHECK(shorter[k].stamp_s == longer[k].stamp_s);
    CHECK(shorter[k].image.range_m == longer[k].image.range_m);
    CHECK(are_same(shorter[k].T_map_sensor_at_column, longer[k].T_map_sensor_at_column));
  }
}

TEST_CASE("stamps are the middles of scans; the truth starts at the identity and fits columns") {
  const auto scans = drive(short_drive("block", 30));
  const SensorModel sensor = small_sensor();
  CHECK(scans[0].T_map_sensor.matrix() == Pose::Identity().matrix());
  for (std::size_t k = 0; k < scans.size(); ++k) {
    CHECK(scans[k].stamp_s == doctest::Approx(0.1 * static_cast<double>(k) + 0.05));
    const auto& columns = scans[k].T_map_sensor_at_column;
    REQUIRE(columns.size() == 128);
    // The stamp is between those of the two middle columns.
    const Pose middle = interpolate(columns[63], columns[64], 0.5);
    CHECK((middle.translation() - scans[k].T_map_sensor.translation()).norm() < 1e-4);
    if (k > 0) {
      const Pose& last = scans[k - 1].T_map_sensor_at_column.back();
      CHECK((columns.front().translation() - last.translation()).norm() < 0.02);
    }
  }
  const auto sparse = drive(short_drive("handheld-sparse", 2));
  CHECK(sparse[0].stamp_s == doctest::Approx(0.05));
  CHECK(sparse[1].stamp_s == doctest::Approx(0.55));
  // It drives off.
  CHECK(scans.back().T_map_sensor.translation().x() > 3.0);
}

TEST_CASE("presets: lengths, names, and one clear line for anything else") {
  CHECK(drive_preset("block").scans == 200);
  CHECK(drive_preset("town").scans == 4000);
  CHECK(drive_preset("hills").scans == 8000);
  CHECK(drive_preset("indoors").mount.sensor_height_m == 1.4);
  CHECK(drive_preset_names().size() == 12);
  CHECK(refused_with([] { drive_preset("desert"); }, "desert", "block", "town", "hills"));
  CHECK(refused_with([] { DriveSimulator(short_drive("town", 0), small_sensor()); }, "scans is 0"));
  CHECK(refused_with([] { drive_style("indoors"); }, "indoors", "no streets"));
  SensorModel broken = small_sensor();
  broken.columns = 3;
  CHECK(refused_with([&] { DriveSimulator(drive_preset("block"), broken); }, "columns is 3"));
  CHECK_THROWS_AS(DriveSimulator(short_drive("block", 3), small_sensor()).skip(-1), Error);
}

TEST_CASE("what a drive can see is on its true surface, a point in the air far from it") {
  DriveSimulator simulator(short_drive("block", 2), small_sensor());
  const auto visible = simulator.next_visible().value();
  CHECK(visible.size() > 500);
  for (const float distance_m : simulator.distances_to_surface_m(visible, 0.3)) {
    REQUIRE(distance_m < 0.001F);
  }
  CHECK(simulator.next_visible());
  CHECK_FALSE(simulator.next_visible());
  const auto distances_m = simulator.distances_to_surface_m(
      {{0.0F, 0.0F, 0.0F}, {0.0F, 0.0F, -1.85F}, {std::nanf(""), 0.0F, 0.0F}}, 0.5);
  CHECK(std::isinf(distances_m[0]));  // the sensor itself
  CHECK(distances_m[1] < 0.1F);       // the street beneath it
  CHECK(std::isinf(distances_m[2]));  // no point
}

// Whoever changes these numbers on purpose raises kDriveRevision: what was simulated before is
// stored under it.
TEST_CASE("scan 100 of every drive is what it was when it was first made, on every machine") {
  const std::vector<std::tuple<std::string, std::uint64_t, std::uint64_t>> drives = {
      {"block", 0xbb4177e6a0b29114ULL, 0x5de58f33287eb1a9ULL},
      {"town", 0x51552d2876dd7583ULL, 0x150b4a47645a8009ULL},
      {"hills", 0xd1a812828d10d030ULL, 0x1806e01571c1ebf2ULL},
      {"town-busy", 0xb19e45857bd1b343ULL, 0x9f42b7a9639ed5b8ULL},
      {"hills-busy", 0x88bdcff427ddb95fULL, 0x9fd35ac0ba7fa44fULL},
      {"meadow", 0xccccf5623be6e917ULL, 0x7141301b089cebd2ULL},
      {"narrow", 0xc3464009135335f1ULL, 0xe64838a53cf4d8e8ULL},
      {"handheld", 0xdb4d4f70baf0ec6bULL, 0x5e5b145daad8685dULL},
      {"handheld-turning", 0x490d98b2ddc6a4c8ULL, 0x4795cb2ba9a7f425ULL},
      {"handheld-sparse", 0x773837575d6b8b35ULL, 0x33a8c91a55aed1c0ULL},
      {"car-park", 0x814bd4dd8f57d4b7ULL, 0x0f55a1fdc0cfb804ULL},
      {"indoors", 0x443388fc3c412347ULL, 0xe084973fe7c80178ULL},
  };
  CHECK(drives.size() == drive_preset_names().size());
  for (const auto& [drive, usual, varied] : drives) {
    CAPTURE(drive);
    const DriveSpec spec = drive_preset(drive);
    CHECK(hash_of_scan(spec, 100) == usual);
    CHECK(hash_of_scan(with_varied_conditions(spec), 100) == varied);
  }
}

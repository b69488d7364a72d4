#include "train/training_scans.h"

#include "hqslam/core/projection.h"
#include "hqslam/nn/network_json.h"
#include "hqslam/nn/training/drawn_beams.h"
#include "made_images.h"
#include "points_file.h"

namespace hqslam::tools {
namespace {

using test::TemporaryDirectory;

SensorModel tiny_sensor() { return test::preset_with("os1-16", 64); }

nn::TrainingConfiguration training_for(const SensorModel& sensor, bool with_memory = false,
                                       bool any_beams = false) {
  nn::TrainingConfiguration configuration;
  configuration.network = nn::network_from_json(
      fmt::format(R"({{"kind": "du-mix", "sensor": {}, "measured_rows": {}, "denoiser":
                      {{"scan_memory": {}, "any_beams": {}}}}})",
                  sensor_json(sensor), sensor.rows() / 4, with_memory, any_beams),
      "test");
  return configuration;
}

/// A stack whose pixels all hold 10 * number + i in image i; returns its path.
std::string stack(const TemporaryDirectory& folder, int number, int images) {
  const std::string path = folder.file(std::to_string(number) + ".npy");
  NpyStackWriter writer(path, 16, 64);
  for (int i = 0; i < images; ++i) {
    writer.append(test::flat_image(16, 64, static_cast<float>(10 * number + i)));
  }
  return path;
}

std::unique_ptr<const StoredScans> stored(const nn::ScanSet& set,
                                          const nn::TrainingConfiguration& configuration,
                                          const DriveStore& store) {
  return stored_scans(set, configuration, store, "scans", InterruptGuard());
}

}  // namespace

TEST_CASE("scans of several files are numbered through, many threads read them at once") {
  const TemporaryDirectory folder;
  const StoredScans scans({{stack(folder, 1, 2)}, {stack(folder, 2, 1)}, {stack(folder, 3, 3)}},
                          tiny_sensor());
  const std::vector<float> expected = {10.0F, 11.0F, 20.0F, 30.0F, 31.0F, 32.0F};
  REQUIRE(scans.size() == 6);
  std::vector<int> wrong(4, 0);
  std::vector<std::thread> threads;
  for (int k = 0; k < 4; ++k) {
    threads.emplace_back([&, k] {
      for (int i = 0; i < 60; ++i) {
        const auto scan = static_cast<std::size_t>((i * 7 + k) % 6);
        const RangeImage image = scans.read(static_cast<std::int64_t>(scan)).truth;
        wrong[k] += image.range_m == std::vector<float>(16 * 64, expected[scan]) ? 0 : 1;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  CHECK(wrong == std::vector<int>(4, 0));
}

TEST_CASE("values that are no range are no return; a file that is no scan is an Error") {
  const TemporaryDirectory folder;
  RangeImage bad(16, 64);
  std::ranges::copy(std::array{NAN, HUGE_VALF, -1.0F, 4.0F}, bad.range_m.begin());
  test::write_stack(folder.file("bad.npy"), {bad});
  const StoredScans scans({{folder.file("bad.npy")}}, tiny_sensor());
  const RangeImage image = scans.read(0).truth;
  CHECK(std::vector(image.range_m.begin(), image.range_m.begin() + 4) ==
        std::vector{0.0F, 0.0F, 0.0F, 4.0F});
  CHECK(test::refused_with([&] { scans.read(1); }, "scan 1", "0 to 0"));
  CHECK(test::refused_with([&] { scans.read(-1); }, "scan -1"));
  CHECK(
      test::refused_with([&] { StoredScans({{folder.file("bad.npy")}}, sensor_preset("os1-16")); },
                         "16 x 64", "16 x 1024"));
  test::write_file(folder.file("bad.npy"), "no longer");
  CHECK(test::refused_with([&] { scans.read(0); }, "bad.npy"));
}

TEST_CASE("a set is its stacks, then its drives, usual or varied, of a sensor that is off") {
  const TemporaryDirectory folder;
  nn::ScanSet set;
  set.stacks = {{stack(folder, 1, 1)}};
  set.simulated = {
      {.drive = "block", .seeds = {5}, .scans = 1},
      {.drive = "block", .seeds = {6}, .scans = 1, .conditions = nn::DriveConditions::kVaried}};
  const auto scans = stored(set, training_for(tiny_sensor()), {folder.file("drives"), 2});
  REQUIRE(scans != nullptr);
  REQUIRE(scans->size() == 3);
  CHECK(scans->read(0).truth.range_m.front() == 10.0F);
  sim::DriveSpec spec{"block", 5, 1, {}, {}, sim::SensorErrors::kTypical};
  CHECK(scans->read(1).truth.range_m ==
        sim::DriveSimulator(spec, tiny_sensor()).next()->image.range_m);
  spec.seed = 6;
  CHECK(
      scans->read(2).truth.range_m ==
      sim::DriveSimulator(sim::with_varied_conditions(spec), tiny_sensor()).next()->image.range_m);
}

TEST_CASE("a network with a memory gets what every scan recalls of those before it") {
  const TemporaryDirectory folder;
  nn::ScanSet set;
  set.simulated = {{.drive = "block", .seeds = {5}, .scans = 7, .every = 3}};
  const DriveStore store{folder.path(), 1};
  const auto scans = stored(set, training_for(tiny_sensor(), true), store);
  const auto without = stored(set, training_for(tiny_sensor()), store);
  REQUIRE(scans->size() == 3);
  for (std::int64_t i = 0; i < 3; ++i) {
    const auto [truth, recalled, own_sensor] = scans->read(i);
    CHECK_FALSE(own_sensor.has_value());
    CHECK(truth.range_m == without->read(i).truth.range_m);
    CHECK(without->read(i).recalled.is_empty());
    int agreeing = 0;
    for (std::size_t pixel = 0; pixel < truth.range_m.size(); ++pixel) {
      REQUIRE((recalled.weight[pixel] > 0.0F) == (recalled.image.range_m[pixel] > 0.0F));
      agreeing += recalled.weight[pixel] > 0.0F &&
                  std::fabs(recalled.image.range_m[pixel] - truth.range_m[pixel]) < 0.3F;
    }
    CHECK((i == 0 ? agreeing == 0 : agreeing > 100));
  }
}

TEST_CASE("a drive with a sensor of its own is simulated and recalls with that one's rows") {
  const TemporaryDirectory folder;
  nn::TrainingConfiguration configuration = training_for(tiny_sensor(), true, true);
  const SensorModel many = test::even_sensor(272, tiny_sensor().columns, 34.0, 0.25);
  configuration.drawn_from = many;
  nn::ScanSet set;
  set.simulated = {{.drive = "block", .seeds = {5, 6}, .scans = 3, .every = 2, .own_sensors = true},
                   {.drive = "block", .seeds = {7}, .scans = 1}};
  const auto scans = stored(set, configuration, {folder.path(), 1});
  REQUIRE(scans->size() == 5);
  for (const std::uint64_t seed : {5U, 6U}) {
    const nn::TrainingScan scan = scans->read(seed == 5 ? 1 : 3);
    const nn::DrawnBeams beams = nn::draw_beams(many, seed, false);
    REQUIRE(scan.sensor.has_value());
    CHECK(scan.sensor->sensor.beam_elevation_rad == beams.sensor.beam_elevation_rad);
    CHECK(scan.sensor->measured_rows == beams.measured_rows);
    CHECK(scan.truth.rows == beams.sensor.rows());
    CHECK(scan.truth.columns == beams.sensor.columns);
    CHECK_FALSE(scan.recalled.is_empty());
  }
  CHECK_FALSE(scans->read(4).sensor.has_value());
  CHECK(scans->read(4).truth.rows == 16);
}

TEST_CASE("a drive that looks ahead gets what every scan recalls of those around it") {
  const TemporaryDirectory folder;
  const auto recalled_pixels = [&](bool look_ahead) {
    nn::ScanSet set;
    set.simulated = {{.drive = "block", .seeds = {5}, .scans = 30, .every = 4}};
    set.simulated.front().look_ahead = look_ahead;
    const auto scans = stored(set, training_for(tiny_sensor(), true), {folder.path(), 1});
    REQUIRE(scans->size() == 8);
    std::vector<std::int64_t> pixels;
    for (std::int64_t i = 0; i < 8; ++i) {
      const std::vector<float> weight = scans->read(i).recalled.weight;
      pixels.push_back(std::ranges::count_if(weight, [](float w) { return w > 0.0F; }));
    }
    return pixels;
  };
  const auto before = recalled_pixels(false);
  const auto around = recalled_pixels(true);
  CHECK(before[0] == 0);
  CHECK(around[0] > 100);
  for (int i = 1; i < 7; ++i) CHECK(around[i] > before[i]);
}

TEST_CASE("a recording's folder is what is in it now, without the scans that are no scans") {
  const TemporaryDirectory folder;
  SensorModel sensor = sensor_preset("os1-16");
  std::filesystem::create_directory(folder.file("scans"));
  nn::ScanSet set;
  set.stacks = {{folder.file("scans")}};
  const auto scans_now = [&] {
    return stored(set, training_for(sensor), {folder.file("store"), 1})->size();
  };
  for (int i = 0; i < 3; ++i) {
    const RangeImage image = test::flat_image(16, 1024, 5.0F + static_cast<float>(i));
    test::write_points(points_of(unproject(image, sensor, CaptureTime::kMotionCorrected)),
                       folder.file(fmt::format("scans/{}.pcd", i)));
  }
  CHECK(scans_now() == 3);
  std::filesystem::remove(folder.file("scans/2.pcd"));
  CHECK(scans_now() == 2);
  test::write_file(folder.file("scans/1.pcd"), "no longer");
  CHECK(scans_now() == 1);
}

}  // namespace hqslam::tools

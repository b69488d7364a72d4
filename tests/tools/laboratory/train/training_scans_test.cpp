#include "laboratory/train/training_scans.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <csignal>
#include <filesystem>
#include <thread>

#include "file_contents.h"
#include "files/result_files.h"
#include "hqslam/core/npy.h"
#include "hqslam/core/pcd.h"
#include "hqslam/core/projection.h"
#include "hqslam/nn/network_json.h"
#include "hqslam/sim/drive.h"
#include "temporary_directory.h"
#include "thread_ranks.h"
#include "tools/parts_of_text.h"

namespace hqslam::tools {
namespace {

namespace fs = std::filesystem;
using test::file_contents;
using test::TemporaryDirectory;
using test::write_file;

StoredDrive block(std::uint64_t seed, std::int64_t scans, std::int64_t every) {
  sim::DriveSpec spec = sim::drive_preset("block");
  spec.seed = seed;
  spec.scans = scans;
  return {spec, every};
}

SensorModel tiny_sensor() {
  SensorModel sensor = sensor_preset("os1-16");
  sensor.columns = 64;
  return sensor;
}

nn::NetworkDescription network_for(const SensorModel& sensor, bool with_memory = false) {
  return nn::network_from_json(
      fmt::format(R"({{"kind": "du-mix", "sensor": {}, "measured_rows": {}, "denoiser":
                      {{"scan_memory": {}}}}})",
                  sensor_json(sensor), sensor.rows() / 4, with_memory),
      "test");
}

bool store(const TemporaryDirectory& folder, const std::vector<StoredDrive>& drives, int threads) {
  const InterruptGuard interrupt;
  Ranks alone;
  return store_drives(folder.path(), drives, tiny_sensor(), threads, "drives", interrupt, alone);
}

std::string path_of(const TemporaryDirectory& folder, const StoredDrive& drive) {
  return path_in_store(folder.path(), drive, tiny_sensor());
}

std::int64_t files_in(const TemporaryDirectory& folder) {
  return std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator());
}

}  // namespace

TEST_CASE("a stored drive has every n-th scan of what the simulator makes, by any thread count") {
  const std::vector<StoredDrive> drives = {block(1, 5, 2), block(2, 2, 1), block(3, 1, 7)};
  const TemporaryDirectory one;
  const TemporaryDirectory three;
  REQUIRE(store(one, drives, 1));
  REQUIRE(store(three, drives, 3));
  for (const StoredDrive& drive : drives) {
    CHECK(file_contents(path_of(one, drive)) == file_contents(path_of(three, drive)));
    NpyStackReader reader(path_of(one, drive));
    REQUIRE(reader.images() == drive.scans());
    sim::DriveSimulator simulator(drive.spec, tiny_sensor());
    for (std::int64_t k = 0; k < drive.scans(); ++k) {
      CHECK(reader.read(k).range_m == simulator.next()->image.range_m);
      simulator.skip(drive.every - 1);
    }
  }
  CHECK(files_in(three) == 3);
}

TEST_CASE("what is there stays, what is missing or damaged is made") {
  const TemporaryDirectory folder;
  const std::vector<StoredDrive> drives = {block(1, 1, 1), block(2, 1, 1), block(3, 1, 1)};
  REQUIRE(store(folder, drives, 2));
  const std::string whole = file_contents(path_of(folder, drives[1]));
  const auto before = fs::last_write_time(path_of(folder, drives[0]));
  write_file(path_of(folder, drives[1]), whole.substr(0, whole.size() - 4));
  fs::remove(path_of(folder, drives[2]));
  REQUIRE(store(folder, drives, 2));
  CHECK(fs::last_write_time(path_of(folder, drives[0])) == before);
  CHECK(file_contents(path_of(folder, drives[1])) == whole);
  CHECK(fs::exists(path_of(folder, drives[2])));
}

TEST_CASE("whatever decides the bytes decides the name") {
  const TemporaryDirectory folder;
  const StoredDrive drive = block(1, 4, 2);
  std::vector<StoredDrive> others(9, drive);
  others[0].spec.name = "town";
  others[1].spec.seed = 2;
  others[2].spec.scans = 3;
  others[3].every = 3;
  others[4].spec.mount.sensor_height_m = 1.0;
  others[5].spec.mount.mount_pitch_rad = 0.01;
  others[6].spec.conditions.dropout_share = 0.01;
  others[7].spec.conditions.extinction_per_m = 0.01;
  others[8].spec = sim::with_varied_conditions(drive.spec);
  for (const StoredDrive& other : others) CHECK(path_of(folder, other) != path_of(folder, drive));
  SensorModel sensor = tiny_sensor();
  sensor.max_range_m += 1.0;
  CHECK(path_in_store(folder.path(), drive, sensor) != path_of(folder, drive));
}

TEST_CASE("asked to stop, it leaves whole drives only and says so") {
  const TemporaryDirectory folder;
  const InterruptGuard interrupt;
  Ranks alone;
  std::raise(SIGTERM);
  CHECK_FALSE(store_drives(folder.path(), {block(1, 2, 1), block(2, 2, 1)}, tiny_sensor(), 2,
                           "drives", interrupt, alone));
  CHECK(files_in(folder) == 0);
}

TEST_CASE("what a killed program left is removed, what another program is at stays") {
  const TemporaryDirectory folder;
  write_file(folder.file("block_9_abc.npy.77.part"), "left");
  write_file(folder.file("block_8_abc.npy.78.part"), "at work");
  const FileLock lock(folder.file("block_8_abc.npy.78.part"));
  REQUIRE(store(folder, {block(1, 1, 1)}, 1));
  CHECK_FALSE(fs::exists(folder.file("block_9_abc.npy.77.part")));
  CHECK(fs::exists(folder.file("block_8_abc.npy.78.part")));
  CHECK(files_in(folder) == 2);
}

TEST_CASE("files of somebody else that end as its own do stay") {
  const TemporaryDirectory folder;
  const std::vector<std::string> foreign = {
      "holiday.mp4.part", "recording_0123456789abcdef.npy.part", "scans.npy.77.part",
      "block_9_abc.npy.x.part", "block_9_abc.npy.77.part.part"};
  for (const std::string& name : foreign) write_file(folder.file(name), "mine");
  REQUIRE(store(folder, {block(1, 1, 1)}, 1));
  for (const std::string& name : foreign) {
    CAPTURE(name);
    CHECK(fs::exists(folder.file(name)));
  }
}

TEST_CASE("several ranks make each drive once, and stop together") {
  const TemporaryDirectory folder;
  const std::vector<StoredDrive> drives = {block(1, 2, 1), block(2, 2, 1), block(3, 2, 1)};
  REQUIRE(store(folder, {drives[1]}, 1));
  const std::string there = path_of(folder, drives[1]);
  const auto before = fs::last_write_time(there);
  const InterruptGuard interrupt;
  test::on_ranks(2, [&](Ranks& ranks) {
    CHECK(store_drives(folder.path(), drives, tiny_sensor(), 1, "drives", interrupt, ranks));
    for (const StoredDrive& drive : drives) CHECK(fs::exists(path_of(folder, drive)));
  });
  CHECK(files_in(folder) == 3);
  CHECK(fs::last_write_time(there) == before);
  const TemporaryDirectory alone;
  REQUIRE(store(alone, drives, 1));
  for (const StoredDrive& drive : drives) {
    CHECK(file_contents(path_of(folder, drive)) == file_contents(path_of(alone, drive)));
  }
}

TEST_CASE("a drive that cannot be, and a folder that cannot be, are one line") {
  const TemporaryDirectory folder;
  CHECK(refuses({"scans is 0"}, [&] { store(folder, {block(1, 0, 1)}, 1); }));
  write_file(folder.file("file"), "x");
  const InterruptGuard interrupt;
  Ranks alone;
  CHECK(refuses({"file"}, [&] {
    store_drives(folder.path() / "file", {block(1, 1, 1)}, tiny_sensor(), 1, "drives", interrupt,
                 alone);
  }));
}

namespace {

using test::TemporaryDirectory;

/// A file with the points of a scan all of whose ranges are 5 m; returns its path.
std::string sensor_pcd(const TemporaryDirectory& folder, const SensorModel& sensor) {
  RangeImage image(sensor.rows(), sensor.columns);
  for (float& range_m : image.range_m) range_m = 5.0F;
  const std::string path = folder.file("scan.pcd");
  write_pcd(points_of(unproject(image, sensor, CaptureTime::kMotionCorrected)), path);
  return path;
}

/// A stack whose pixels all hold 10 * number + i in image i; returns its path.
std::string stack(const TemporaryDirectory& folder, int number, int images) {
  const std::string path = folder.file(std::to_string(number) + ".npy");
  NpyStackWriter writer(path, 16, 64);
  for (int i = 0; i < images; ++i) {
    RangeImage image(16, 64);
    for (float& range_m : image.range_m) range_m = static_cast<float>(10 * number + i);
    writer.append(image);
  }
  return path;
}

}  // namespace

TEST_CASE("scans of several files are numbered through, many threads read them at once") {
  const TemporaryDirectory folder;
  const StoredScans scans({stack(folder, 1, 2), stack(folder, 2, 1), stack(folder, 3, 3)},
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

TEST_CASE("what is no range is no return; what is no scan is an Error") {
  const TemporaryDirectory folder;
  {
    NpyStackWriter writer(folder.file("bad.npy"), 16, 64);
    RangeImage image(16, 64);
    image.range_m[0] = std::nanf("");
    image.range_m[1] = HUGE_VALF;
    image.range_m[2] = -1.0F;
    image.range_m[3] = 4.0F;
    writer.append(image);
  }
  const StoredScans scans({folder.file("bad.npy")}, tiny_sensor());
  const RangeImage image = scans.read(0).truth;
  CHECK(image.range_m[0] == 0.0F);
  CHECK(image.range_m[1] == 0.0F);
  CHECK(image.range_m[2] == 0.0F);
  CHECK(image.range_m[3] == 4.0F);
  CHECK(refuses({"scan 1", "0 to 0"}, [&] { scans.read(1); }));
  CHECK(refuses({"scan -1"}, [&] { scans.read(-1); }));
  CHECK(refuses({"16 x 64", "16 x 1024"},
                [&] { StoredScans({folder.file("bad.npy")}, sensor_preset("os1-16")); }));
  test::write_file(folder.file("bad.npy"), "no longer");
  CHECK(refuses({"bad.npy"}, [&] { scans.read(0); }));
}

TEST_CASE("a set is its stacks, then its drives, usual or of varied conditions") {
  const TemporaryDirectory folder;
  nn::ScanSet set;
  set.stacks = {stack(folder, 1, 1)};
  set.simulated = {
      {.drive = "block", .seeds = {5}, .scans = 1},
      {.drive = "block", .seeds = {6}, .scans = 1, .conditions = nn::DriveConditions::kVaried}};
  const InterruptGuard interrupt;
  Ranks alone;
  const auto scans = stored_scans(set, network_for(tiny_sensor()),
                                  {folder.path() / "drives", 2, alone}, "scans", interrupt);
  REQUIRE(scans != nullptr);
  REQUIRE(scans->size() == 3);
  CHECK(scans->read(0).truth.range_m.front() == 10.0F);
  sim::DriveSpec spec = sim::drive_preset("block");
  spec.scans = 1;
  spec.seed = 5;
  CHECK(scans->read(1).truth.range_m ==
        sim::DriveSimulator(spec, tiny_sensor()).next()->image.range_m);
  spec.seed = 6;
  CHECK(
      scans->read(2).truth.range_m ==
      sim::DriveSimulator(sim::with_varied_conditions(spec), tiny_sensor()).next()->image.range_m);
  set.stacks = {"$HQSLAM_NO_SUCH_FOLDER/a.npy"};
  CHECK(refuses({"HQSLAM_NO_SUCH_FOLDER is not set"}, [&] {
    stored_scans(set, network_for(tiny_sensor()), {folder.path(), 1, alone}, "scans", interrupt);
  }));
}

TEST_CASE("a network with a memory gets what every scan recalls of those before it") {
  const TemporaryDirectory folder;
  nn::ScanSet set;
  set.simulated = {{.drive = "block", .seeds = {5}, .scans = 7, .every = 3}};
  const InterruptGuard interrupt;
  Ranks alone;
  const DriveStore store{folder.path(), 1, alone};
  const auto scans = stored_scans(set, network_for(tiny_sensor(), true), store, "scans", interrupt);
  const auto without = stored_scans(set, network_for(tiny_sensor()), store, "scans", interrupt);
  REQUIRE(scans->size() == 3);
  for (std::int64_t i = 0; i < 3; ++i) {
    const auto [truth, recalled] = scans->read(i);
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

TEST_CASE("a recording's folder is what is in it now, without the scans that are no scans") {
  const TemporaryDirectory folder;
  SensorModel sensor = sensor_preset("os1-16");
  const std::string file = sensor_pcd(folder, sensor);
  std::filesystem::create_directory(folder.file("scans"));
  const InterruptGuard interrupt;
  Ranks alone;
  nn::ScanSet set;
  set.stacks = {folder.file("scans")};
  const auto scans_now = [&] {
    return stored_scans(set, network_for(sensor), {folder.path() / "store", 1, alone}, "scans",
                        interrupt)
        ->size();
  };
  for (const char* name : {"0.pcd", "1.pcd", "2.pcd"}) {
    std::filesystem::copy(file, folder.path() / "scans" / name);
  }
  CHECK(scans_now() == 3);
  std::filesystem::remove(folder.path() / "scans/2.pcd");
  CHECK(scans_now() == 2);
  test::write_file(folder.file("scans/1.pcd"), "no longer");
  CHECK(scans_now() == 1);
}

}  // namespace hqslam::tools

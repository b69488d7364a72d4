#include "train/drive_store.h"

#include <csignal>

#include "files/result_files.h"
#include "made_images.h"

namespace hqslam::tools {
namespace {

namespace fs = std::filesystem;

StoredDrive block(std::uint64_t seed, std::int64_t scans, std::int64_t every) {
  return {{"block", seed, scans, {}, {}}, preset_with("os1-16", 64), every};
}

bool store(const std::string& folder, const std::vector<StoredDrive>& drives, int threads) {
  const InterruptGuard interrupt;
  return store_drives({folder, threads}, drives, "drives", interrupt);
}

std::string path_of(const TemporaryDirectory& folder, const StoredDrive& drive) {
  return path_in_store(folder.path(), drive);
}

std::int64_t files_in(const TemporaryDirectory& folder) {
  return std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator());
}

}  // namespace

TEST_CASE("a stored drive has every n-th scan of what the simulator makes, by any thread count") {
  const std::vector<StoredDrive> drives = {block(1, 5, 2), block(2, 2, 1), block(3, 1, 7)};
  const TemporaryDirectory one;
  const TemporaryDirectory three;
  REQUIRE(store(one.path(), drives, 1));
  REQUIRE(store(three.path(), drives, 3));
  for (const StoredDrive& drive : drives) {
    CHECK(file_contents(path_of(one, drive)) == file_contents(path_of(three, drive)));
    NpyStackReader reader(path_of(one, drive));
    REQUIRE(reader.images() == drive.scans());
    sim::DriveSimulator simulator(drive.spec, drive.sensor);
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
  REQUIRE(store(folder.path(), drives, 2));
  const std::string whole = file_contents(path_of(folder, drives[1]));
  const auto before = fs::last_write_time(path_of(folder, drives[0]));
  write_file(path_of(folder, drives[1]), whole.substr(0, whole.size() - 4));
  fs::remove(path_of(folder, drives[2]));
  REQUIRE(store(folder.path(), drives, 2));
  CHECK(fs::last_write_time(path_of(folder, drives[0])) == before);
  CHECK(file_contents(path_of(folder, drives[1])) == whole);
  CHECK(fs::exists(path_of(folder, drives[2])));
}

TEST_CASE("a drive that is named several times is made once") {
  const TemporaryDirectory folder;
  const std::vector<StoredDrive> drives(8, block(1, 30, 1));
  REQUIRE(store(folder.path(), drives, 8));
  CHECK(NpyStackReader(path_of(folder, drives.front())).images() == 30);
  CHECK(files_in(folder) == 1);
}

TEST_CASE("whatever decides the bytes decides the name") {
  const TemporaryDirectory folder;
  const StoredDrive drive = block(1, 4, 2);
  std::vector<StoredDrive> others(10, drive);
  others[0].spec.name = "town";
  others[1].spec.seed = 2;
  others[2].spec.scans = 3;
  others[3].every = 3;
  others[4].spec.mount.sensor_height_m = 1.0;
  others[5].spec.mount.mount_pitch_rad = 0.01;
  others[6].spec.conditions.dropout_share = 0.01;
  others[7].spec.conditions.extinction_per_m = 0.01;
  others[8].spec = sim::with_varied_conditions(drive.spec);
  others[9].sensor.max_range_m += 1.0;
  for (const StoredDrive& other : others) CHECK(path_of(folder, other) != path_of(folder, drive));
}

TEST_CASE("asked to stop, it leaves whole drives only and says so") {
  const TemporaryDirectory folder;
  const InterruptGuard interrupt;
  std::raise(SIGTERM);
  CHECK_FALSE(
      store_drives({folder.path(), 2}, {block(1, 2, 1), block(2, 2, 1)}, "drives", interrupt));
  CHECK(files_in(folder) == 0);
}

TEST_CASE("a drive that cannot be, and a folder that cannot be, are one line") {
  const TemporaryDirectory folder;
  CHECK(refused_with([&] { store(folder.path(), {block(1, 0, 1)}, 1); }, "scans is 0"));
  write_file(folder.file("file"), "x");
  CHECK(refused_with([&] { store(folder.file("file"), {block(1, 1, 1)}, 1); }, "file"));
}

}  // namespace hqslam::tools

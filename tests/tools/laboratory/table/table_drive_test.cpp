#include "laboratory/table/table_drive.h"

#include <doctest/doctest.h>

#include <filesystem>
#include <set>

#include "file_contents.h"
#include "hqslam/core/npy.h"
#include "temporary_directory.h"

namespace hqslam::tools {
namespace {

/// A stack of images of 16 x 64 pixels, image i filled with ranges[i].
void write_stack(const std::vector<float>& ranges_m, const std::string& path) {
  NpyStackWriter writer(path, 16, 64);
  for (const float range_m : ranges_m) {
    RangeImage image(16, 64);
    image.range_m.assign(image.range_m.size(), range_m);
    writer.append(image);
  }
}

std::string identity(const std::string& recording, std::int64_t scans) {
  TableDrive drive;
  drive.recording.input = recording;
  return identity_of(drive, scans);
}

}  // namespace

TEST_CASE("a stack is known by the images that are used, wherever it lies") {
  const test::TemporaryDirectory folder;
  write_stack({1.0F, 2.0F}, folder.file("a.npy"));
  std::filesystem::create_directory(folder.file("drive"));
  write_stack({1.0F, 2.0F, 3.0F}, folder.file("drive/scans.npy"));
  const std::string two = identity(folder.file("a.npy"), 2);
  CHECK(identity(folder.file("drive"), 2) == two);
  CHECK(identity(folder.file("drive"), 3) != two);
  CHECK(identity(folder.file("a.npy"), 1) != two);
}

TEST_CASE("a recording that is read in another way is another one") {
  const test::TemporaryDirectory folder;
  write_stack({1.0F}, folder.file("a.npy"));
  TableDrive drive{"name", {.input = folder.file("a.npy")}, "", std::nullopt};
  std::set<std::string> identities = {identity_of(drive, 1)};
  for (const auto change :
       {+[](InputChoice& c) { c.stream = "7502"; }, +[](InputChoice& c) { c.kept_return = "last"; },
        +[](InputChoice& c) { c.row_order = "lowest-first"; },
        +[](InputChoice& c) { c.motion_corrected = true; },
        +[](InputChoice& c) { c.capture = "rolling"; },
        +[](InputChoice& c) { c.stamps = "names"; }}) {
    drive.recording = {.input = folder.file("a.npy")};
    change(drive.recording);
    identities.insert(identity_of(drive, 1));
  }
  CHECK(identities.size() == 7);
}

TEST_CASE("scans with other stamps are another recording") {
  const test::TemporaryDirectory folder;
  std::filesystem::create_directories(folder.file("drive/bin"));
  test::write_file(folder.file("drive/bin/0.bin"), "a scan");
  TableDrive drive{"name", {.input = folder.file("drive/bin")}, "", std::nullopt};
  std::set<std::string> identities = {identity_of(drive, 1)};
  for (const char* times : {"1\n", "2\n"}) {
    test::write_file(folder.file("drive/timestamps.txt"), times);
    identities.insert(identity_of(drive, 1));
  }
  drive.recording.stamps = folder.file("stamps.txt");
  for (const char* times : {"1\n", "2\n"}) {
    test::write_file(drive.recording.stamps, times);
    identities.insert(identity_of(drive, 1));
  }
  CHECK(identities.size() == 5);
}

TEST_CASE("as many other scans at the same path are another recording") {
  const test::TemporaryDirectory folder;
  write_stack({1.0F, 2.0F}, folder.file("a.npy"));
  const std::string before = identity(folder.file("a.npy"), 2);
  write_stack({1.0F, 0.0F}, folder.file("a.npy"));
  CHECK(identity(folder.file("a.npy"), 2) != before);
}

TEST_CASE("a simulated drive is there only while its files can be read") {
  const test::TemporaryDirectory folder;
  TableDrive drive{"block", {.input = folder.file("drive")}, "", sim::drive_preset("block")};
  drive.simulated->scans = 1;
  const InterruptGuard interrupt;
  CHECK_FALSE(is_there(drive));
  for (const char* damaged : {"sensor.json", "drive.json", "scans.npy", "truth.tum"}) {
    CAPTURE(damaged);
    REQUIRE(prepare_drive(drive, interrupt, [] {}));
    CHECK(is_there(drive));
    test::write_file(folder.file(std::string("drive/") + damaged), "damaged");
    CHECK_FALSE(is_there(drive));
    if (damaged == std::string("drive.json")) std::filesystem::remove_all(folder.file("drive"));
  }
}

TEST_CASE("a folder of files is known by their names and bytes, not by its place") {
  const test::TemporaryDirectory folder;
  for (const char* name : {"a", "b"}) {
    std::filesystem::create_directory(folder.file(name));
    test::write_file(folder.file(std::string(name) + "/000000.bin"), "0123456789abcdef");
  }
  const std::string before = identity(folder.file("a"), 1);
  CHECK(identity(folder.file("b"), 1) == before);
  test::write_file(folder.file("b/000000.bin"), "0123456789abcdeF");
  CHECK(identity(folder.file("b"), 1) != before);
  std::filesystem::rename(folder.file("a/000000.bin"), folder.file("a/000001.bin"));
  CHECK(identity(folder.file("a"), 1) != before);
}

}  // namespace hqslam::tools

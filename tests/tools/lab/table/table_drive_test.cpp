#include "table/table_drive.h"

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
  return identity_of({"", {.input = recording}, "", std::nullopt}, scans);
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

TEST_CASE("other scans at the same place, and scans with other stamps, are another recording") {
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
  test::write_file(folder.file("drive/bin/0.bin"), "another scan");
  identities.insert(identity_of(drive, 1));
  CHECK(identities.size() == 6);
}

}  // namespace hqslam::tools

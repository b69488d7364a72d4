#include "recording/drive_folder.h"

#include <doctest/doctest.h>

#include <filesystem>

#include "error_message.h"
#include "file_contents.h"
#include "temporary_directory.h"

namespace hqslam::tools {
namespace {

namespace fs = std::filesystem;
using namespace hqslam::test;

constexpr const char* kDriveJson = R"({"name": "block", "seed": 1, "scans": 5})";

}  // namespace

TEST_CASE("an earlier drive makes room, files beside it stay") {
  const TemporaryDirectory folder;
  fs::create_directory(folder.path() / "bin");
  for (const char* name : {"scans.npy", "sensor.json", "drive.json", "truth.tum", "truth.kitti",
                           "truth_columns.npy", "bin/000003.bin", "bin/mine.bin", "notes.txt"}) {
    write_file(folder.file(name), "x");
  }
  write_file(folder.file("drive.json"), kDriveJson);
  clear_drive_folder(folder.path().string());
  CHECK(fs::exists(folder.file("notes.txt")));
  CHECK(fs::exists(folder.file("bin/mine.bin")));
  CHECK_FALSE(fs::exists(folder.file("bin/000003.bin")));
  CHECK_FALSE(fs::exists(folder.file("scans.npy")));
}

TEST_CASE("a file of the same name that is no drive's is neither replaced nor removed") {
  for (const char* name : {"scans.npy", "truth.tum", "sensor.json", "bin"}) {
    CAPTURE(name);
    const TemporaryDirectory folder;
    write_file(folder.file(name), "mine");
    CHECK(one_line_with(error_message([&] { clear_drive_folder(folder.path().string()); }), name,
                        "--out"));
    CHECK(fs::exists(folder.file(name)));
  }
}

TEST_CASE("the beginning of a drive whose disk was full makes room as well") {
  const TemporaryDirectory folder;
  write_file(folder.file("drive.json"), kDriveJson);
  write_file(folder.file("scans.npy"), "");
  CHECK_NOTHROW(clear_drive_folder(folder.path().string()));
  CHECK_FALSE(fs::exists(folder.file("scans.npy")));
}

TEST_CASE("a folder that is not there or is empty needs nothing") {
  const TemporaryDirectory folder;
  CHECK_NOTHROW(clear_drive_folder(folder.path().string()));
  CHECK_NOTHROW(clear_drive_folder(folder.file("new")));
}

}  // namespace hqslam::tools

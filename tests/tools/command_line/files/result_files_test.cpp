#include "files/result_files.h"

#include <sys/stat.h>

#include "testing.h"

namespace hqslam::tools {
namespace {

namespace fs = std::filesystem;

bool always(const std::string&) { return true; }

}  // namespace

TEST_CASE("no device, pipe, folder or input is overwritten, whatever program made it") {
  const TemporaryDirectory folder;
  mkfifo(folder.file("pipe").c_str(), 0600);
  fs::create_directory(folder.file("folder"));
  fs::create_symlink("/dev/null", folder.file("link"));
  write_file(folder.file("input"), "x");
  fs::create_hard_link(folder.file("input"), folder.file("same"));
  CHECK_FALSE(has_marker(folder.file("pipe"), "x"));
  for (const char* name : {"pipe", "folder", "link", "same"}) {
    CAPTURE(name);
    CHECK(refused_with(
        [&] { guard_output_file(folder.file(name), {folder.file("input")}, always); }, "--out"));
  }
  CHECK(refused_with([] { guard_output_file("/dev/null", {}, always); }, "/dev/null",
                     "no regular file"));
}

TEST_CASE("an earlier drive makes room, files beside it stay") {
  const TemporaryDirectory folder;
  fs::create_directory(folder.file("bin"));
  for (const char* name : {"scans.npy", "sensor.json", "drive.json", "truth.tum", "truth.kitti",
                           "truth_columns.npy", "bin/000003.bin", "bin/mine.bin", "notes.txt"}) {
    write_file(folder.file(name), "x");
  }
  write_file(folder.file("drive.json"), R"({"name": "block", "seed": 1, "scans": 5})");
  clear_drive_folder(folder.path());
  CHECK(fs::exists(folder.file("notes.txt")));
  CHECK(fs::exists(folder.file("bin/mine.bin")));
  CHECK_FALSE(fs::exists(folder.file("bin/000003.bin")));
  CHECK_FALSE(fs::exists(folder.file("scans.npy")));
}

}  // namespace hqslam::tools

#include "hqslam/core/whole_file.h"

#include <sys/stat.h>

#include "hqslam/core/npy.h"
#include "testing.h"

TEST_CASE("a file is replaced whole or not at all, without partial files left behind") {
  const TemporaryDirectory folder;
  const std::string path = folder.file("a");
  replace_file(path, [](const std::string& part) { write_whole_file(part, "one"); });
  CHECK(whole_file(path, "a file", 3) == "one");
  CHECK_THROWS_AS(replace_file(path,
                               [](const std::string& part) {
                                 write_whole_file(part, "two");
                                 throw std::runtime_error("the disk is full");
                               }),
                  std::runtime_error);
  CHECK(file_contents(path) == "one");
  CHECK_FALSE(std::filesystem::exists(path + ".part"));
}

TEST_CASE("a place that cannot be written is one line") {
  const TemporaryDirectory folder;
  std::filesystem::create_directory(folder.file("taken"));
  const auto write = [](const std::string& part) { write_whole_file(part, "one"); };
  CHECK(refused_with([&] { replace_file(folder.file("no/a"), write); }, "no/a"));
  CHECK(refused_with([&] { replace_file(folder.file("taken"), write); }, "taken",
                     "cannot be written"));
  CHECK_FALSE(std::filesystem::exists(folder.file("taken.part")));
}

TEST_CASE("what is too long, folders, devices and pipes, which could block, are refused unread") {
  const TemporaryDirectory folder;
  const std::string pipe = folder.file("scans.npy");
  REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
  const auto refuse = [](const std::string& path, const char* found) {
    CHECK(refused_with([&] { whole_file(path, "a file", 3); }, path, found));
    CHECK(refused_with([&] { NpyStackReader reader(path); }, path, found));
  };
  write_file(folder.file("a"), "four");
  CHECK(refused_with([&] { whole_file(folder.file("a"), "text", 3); }, "at most 3 bytes, found 4"));
  refuse(folder.path(), "found a folder");
  refuse(folder.file("none"), "found no file");
  refuse("/dev/zero", "found a pipe or a device");
  refuse(pipe, "found a pipe or a device");
}

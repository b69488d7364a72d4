#include "hqslam/core/whole_file.h"

#include <doctest/doctest.h>

#include <filesystem>
#include <stdexcept>

#include "error_message.h"
#include "file_contents.h"
#include "temporary_directory.h"

using namespace hqslam;
using namespace hqslam::test;

TEST_CASE("a file is replaced whole or not at all, and no part of it is left") {
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

TEST_CASE("no more is read than is asked for, and no folder or device") {
  const TemporaryDirectory folder;
  write_file(folder.file("a"), "four");
  CHECK(
      refused_with([&] { whole_file(folder.file("a"), "a file", 3); }, "at most 3 bytes, found 4"));
  for (const std::string& path : {folder.path().string(), std::string("/dev/zero")}) {
    CHECK(refused_with([&] { whole_file(path, "a file", 3); }, path));
  }
}

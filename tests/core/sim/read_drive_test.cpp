#include "hqslam/sim/read_drive.h"

#include <doctest/doctest.h>

#include "error_message.h"
#include "file_contents.h"
#include "hqslam/sim/write_drive.h"
#include "small_sensor.h"
#include "temporary_directory.h"

using namespace hqslam;
using namespace hqslam::sim;
using namespace hqslam::test;

TEST_CASE("a drive is read as it was written, with its mount and conditions") {
  for (const bool varied : {false, true}) {
    const TemporaryDirectory folder;
    DriveSpec spec{"town", 0xFFFFFFFFFFFFFFFFU, 12, {}, {}};
    if (varied) spec = with_varied_conditions(spec);
    { const DriveWriter writer(folder.path().string(), spec, small_sensor()); }
    const DriveSpec read = read_drive_json(folder.file("drive.json"));
    CHECK(read.name == spec.name);
    CHECK(read.seed == spec.seed);
    CHECK(read.scans == spec.scans);
    CHECK(read.mount == spec.mount);
    CHECK(read.conditions == spec.conditions);
  }
}

TEST_CASE("what is no drive.json is an error of one line that names the file") {
  const TemporaryDirectory folder;
  const std::string path = folder.file("drive.json");
  const auto message_for = [&](const std::string& text) {
    write_file(path, text);
    return error_message([&] { read_drive_json(path); });
  };
  CHECK(one_line_with(error_message([&] { read_drive_json(path); }), path, "found no file"));
  CHECK(one_line_with(message_for("not json"), path, "JSON"));
  CHECK(one_line_with(message_for("[]"), path, "object"));
  CHECK(one_line_with(message_for(R"({"name": "town", "seed": 1})"), path, "scans"));
  CHECK(one_line_with(message_for(R"({"name": "town", "seed": -1, "scans": 3})"), path, "seed"));
  CHECK(one_line_with(message_for(R"({"name": "town", "seed": 1, "scans": 0})"), "scans"));
  CHECK(one_line_with(message_for(R"({"name": "moon", "seed": 1, "scans": 3})"), "moon"));
  CHECK(one_line_with(message_for(R"({"name": "town", "seed": 1, "scans": 3, "mount": 4})"), path,
                      "mount"));
  CHECK(one_line_with(message_for(std::string(100000, ' ')), path, "bytes"));
}

#include "recording/recording_choice.h"

#include <doctest/doctest.h>

#include "error_message.h"
#include "file_contents.h"
#include "temporary_directory.h"

namespace hqslam::tools {

using namespace hqslam::test;

TEST_CASE("the sensor that is named comes before the one in the folder") {
  const TemporaryDirectory folder;
  write_sensor_json(sensor_preset("vlp-16"), folder.file("sensor.json"));
  const std::string drive = folder.path().string();
  CHECK(recording_sensor({drive})->name == "vlp-16");
  CHECK(recording_sensor({drive, "os1-64"})->name == "os1-64");
  CHECK(file_of_drive(drive, "sensor.json") == folder.file("sensor.json"));
  CHECK(file_of_drive(drive, "truth.tum").empty());
}

TEST_CASE("a recording whose sensor is neither named nor found is one line where one is needed") {
  const TemporaryDirectory folder;
  write_file(folder.file("0.csv"), "5 0 1\n5 0 0\n");
  CHECK_FALSE(recording_sensor({folder.path().string()}).has_value());
  CHECK(refused_with([&] { required_recording_sensor({folder.path().string()}); }, "--sensor"));
}

}  // namespace hqslam::tools

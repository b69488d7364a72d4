#include "recording/recording_choice.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>

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

TEST_CASE("what is said of other kinds of recordings is refused by whatever opens one") {
  const TemporaryDirectory folder;
  write_file(folder.file("a.pcap"), std::string("\xD4\xC3\xB2\xA1", 4));
  std::filesystem::create_directory(folder.file("drive"));
  std::filesystem::create_directory(folder.file("points"));
  write_file(folder.file("drive/scans.npy"), "");
  write_sensor_json(sensor_preset("os1-16"), folder.file("drive/sensor.json"));
  write_file(folder.file("points/0.csv"), "5 0 1\n5 0 0\n");
  struct Option {
    const char* name;
    InputChoice choice;
    std::vector<std::string> is_for;
  };
  const Option options[] = {
      {"--stream", {.input = "", .stream = "1"}, {"a.pcap"}},
      {"--return", {.input = "", .kept_return = "last"}, {"a.pcap"}},
      {"--row-order", {.input = "", .row_order = "lowest-first"}, {"a.npy", "drive"}},
      {"--motion-corrected", {.input = "", .motion_corrected = true}, {"a.npy", "drive"}},
      {"--capture", {.input = "", .capture = "corrected"}, {"points", "points/0.csv"}},
      {"--stamps", {.input = "", .stamps = "names"}, {"a.npy", "drive", "points", "points/0.csv"}}};
  for (const Option& option : options) {
    for (const char* name : {"a.pcap", "a.npy", "drive", "points", "points/0.csv"}) {
      CAPTURE(option.name);
      CAPTURE(name);
      InputChoice choice = option.choice;
      choice.input = folder.file(name);
      const bool is_refused = std::ranges::count(option.is_for, name) == 0;
      const std::string leave = std::string(option.name) + " says nothing of ";
      CHECK(one_line_with(error_message([&] { refuse_idle_options(choice); }), leave) ==
            is_refused);
      if (is_refused) CHECK(refused_with([&] { recording_sensor(choice); }, leave));
    }
  }
}

}  // namespace hqslam::tools

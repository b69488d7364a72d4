#include "recording/recording_choice.h"

#include "testing.h"

namespace hqslam::tools {

TEST_CASE("options that do not apply to a kind of recording are refused when it is opened") {
  const TemporaryDirectory folder;
  write_file(folder.file("a.pcap"), std::string("\xD4\xC3\xB2\xA1", 4));
  std::filesystem::create_directory(folder.file("drive"));
  std::filesystem::create_directory(folder.file("points"));
  write_file(folder.file("drive/scans.npy"), "");
  write_sensor_json(sensor_preset("os1-16"), folder.file("drive/sensor.json"));
  write_file(folder.file("points/0.csv"), "5 0 1\n5 0 0\n");
  const std::vector<std::tuple<std::string, InputChoice, std::vector<std::string>>> options = {
      {"--stream", {.input = "", .stream = "1"}, {"a.pcap"}},
      {"--return", {.input = "", .kept_return = "last"}, {"a.pcap"}},
      {"--row-order", {.input = "", .row_order = "lowest-first"}, {"a.npy", "drive"}},
      {"--capture",
       {.input = "", .capture = "corrected"},
       {"a.npy", "drive", "points", "points/0.csv"}},
      {"--stamps", {.input = "", .stamps = "names"}, {"a.npy", "drive", "points", "points/0.csv"}}};
  for (const auto& [option, chosen, is_for] : options) {
    for (const char* name : {"a.pcap", "a.npy", "drive", "points", "points/0.csv"}) {
      CAPTURE(option);
      CAPTURE(name);
      InputChoice choice = chosen;
      choice.input = folder.file(name);
      const auto open = [&] { recordings::Recording::open(choice.input, open_options(choice)); };
      CHECK(one_line_with(error_message(open), option + " does not apply") ==
            (std::ranges::count(is_for, name) == 0));
    }
  }
}

}  // namespace hqslam::tools

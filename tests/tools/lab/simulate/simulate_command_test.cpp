#include "simulate/simulate_command.h"

#include "laboratory.h"
#include "tools/command_line/parsed_options.h"

namespace hqslam::tools {

TEST_CASE("seeds are ranges and single numbers, in the order given") {
  CHECK(seeds_from("7") == std::vector<std::uint64_t>{7});
  CHECK(seeds_from("2..4") == std::vector<std::uint64_t>{2, 3, 4});
  CHECK(seeds_from("9,1..2,5") == std::vector<std::uint64_t>{9, 1, 2, 5});
  CHECK(seeds_from("18446744073709551615").front() == 18446744073709551615ULL);
  CHECK(seeds_from("18446744073709551614..18446744073709551615").size() == 2);
}

TEST_CASE("anything else is refused with the list in one line") {
  for (const char* list : {"", "a", "1..", "..3", "3..1", "1,,2", "1,", "-1", "1..20000", "1.5",
                           "1 2", "1..3,2", "18446744073709551616", "0..18446744073709551615"}) {
    CAPTURE(list);
    const std::string message = error_message([&] { seeds_from(list); });
    CHECK(one_line_with(message, "--seeds", fmt::format("'{}'", list)));
  }
}

TEST_CASE("a seed is a whole number from 0 to 2^64 - 1, and no drive has -3 scans") {
  const auto seed = [](const std::string& text, const std::string& scans = "1") {
    return parsed_options<SimulateOptions>({"simulate", "--drive", "town", "--sensor", "vlp-16",
                                            "--out", "x", "--seed", text, "--scans", scans})
        .seed;
  };
  CHECK(seed("0") == 0);
  CHECK(seed("18446744073709551615") == 18446744073709551615ULL);
  CHECK_THROWS_AS(seed("0", "-3"), CLI::ParseError);
  for (const char* wrong :
       {"-1", "99999999999999999999", "18446744073709551616", "1.5", "0x10", "one", ""}) {
    CAPTURE(wrong);
    CHECK_THROWS_AS(seed(wrong), CLI::ParseError);
  }
}

namespace {

void simulate(const TemporaryDirectory& folder, const std::vector<double>& mount_deg,
              std::int64_t scans = 1) {
  SimulateOptions options;
  options.drive = "block";
  options.sensor = "os1-16";
  options.out = folder.file("drive");
  options.scans = scans;
  options.mount = mount_deg;
  simulate_drive(options, InterruptGuard());
}

}  // namespace

TEST_CASE("a mount is refused in the degrees in which it was given, and a drive that is too long") {
  const TemporaryDirectory folder;
  for (const std::vector<double>& mount_deg :
       {std::vector{200.0, 0.0}, {-180.1, 0.0}, {0.0, 45.1}, {0.0, -46.0}, {std::nan(""), 0.0}}) {
    CHECK(refused_with([&] { simulate(folder, mount_deg); }, "--mount ", "-180 to 180",
                       "-45 to 45 degrees", "give "));
  }
  CHECK_FALSE(std::filesystem::exists(folder.file("drive")));
  simulate(folder, {180.0, -45.0});
  simulate(folder, {-180.0, 45.0});
  CHECK(refused_with([&] { simulate(folder, {}, 1'000'001); }, "scans is 1000001",
                     "1 to 1000000; give "));
}

}  // namespace hqslam::tools

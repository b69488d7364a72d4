#include "simulate/simulate_command.h"

#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>

#include "error_message.h"
#include "temporary_directory.h"

namespace hqslam::tools {
namespace {

using test::error_message;
using test::one_line_with;
using test::TemporaryDirectory;

void simulate(const TemporaryDirectory& folder, const std::vector<double>& mount_deg,
              std::int64_t scans = 1) {
  SimulateOptions options;
  options.drive = "block";
  options.sensor = "os1-16";
  options.out = folder.file("drive");
  options.scans = scans;
  options.mount = mount_deg;
  simulate_drive(options, InterruptGuard(), [] {});
}

}  // namespace

TEST_CASE("a mount is refused in the degrees in which it was given") {
  const TemporaryDirectory folder;
  for (const std::vector<double>& mount_deg :
       {std::vector{200.0, 0.0}, {-180.1, 0.0}, {0.0, 45.1}, {0.0, -46.0}, {std::nan(""), 0.0}}) {
    CHECK(one_line_with(error_message([&] { simulate(folder, mount_deg); }), "--mount ",
                        "-180 to 180", "-45 to 45 degrees", "give "));
  }
  CHECK_FALSE(std::filesystem::exists(folder.file("drive")));
  simulate(folder, {180.0, -45.0});
  simulate(folder, {-180.0, 45.0});
}

TEST_CASE("a drive longer than there can be says how long it may be") {
  const TemporaryDirectory folder;
  CHECK(one_line_with(error_message([&] { simulate(folder, {}, 1'000'001); }), "scans is 1000001",
                      "1 to 1000000; give "));
}

}  // namespace hqslam::tools

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "tools/program/program.h"

namespace hqslam::test {
namespace {

/// A row of what evaluate-map prints of a grid, shares in percent.
struct GridRow {
  double empty_free, empty_occupied, standing_occupied, standing_near, standing_free, moved,
      free_wrong, occupied_wrong;
  std::string rest;
};

GridRow last_row_of(const std::string& text) {
  std::istringstream words(last_line(text));
  GridRow row;
  words >> row.empty_free >> row.empty_occupied >> row.standing_occupied >> row.standing_near >>
      row.standing_free >> row.moved >> row.free_wrong >> row.occupied_wrong;
  std::getline(words, row.rest);
  return row;
}

}  // namespace

TEST_CASE("an occupancy grid agrees with the city that it was driven through") {
  const TemporaryDirectory out;
  const ProgramResult run = succeeds("run '{}' --rows 16 --occupancy-grid --out '{}'",
                                     drive_of_64(), out.path().string());
  CHECK(holds(run.out, "occupancy grid: "));
  CHECK(holds(last_line(run.out), "report.html, map.pgm, map.yaml"));
  CHECK(holds(file_contents(out.file("map.yaml")), "image: map.pgm\nmode: trinary\n"));
  const ProgramResult result =
      succeeds("evaluate-map '{}' --drive '{}'", out.file("map.yaml"), drive_of_64());
  const GridRow row = last_row_of(result.out);
  CAPTURE(result.out);
  CHECK(holds(row.rest, "(aligned)"));
  CHECK(row.empty_free > 70.0);
  CHECK(row.empty_occupied < 2.0);
  CHECK(row.standing_near > 50.0);
  CHECK(row.free_wrong < 5.0);
  CHECK(row.occupied_wrong < 15.0);
}

TEST_CASE("a run gives the same bytes with one thread and with two; its grid goes with it") {
  std::vector<std::string> results;
  const TemporaryDirectory out;
  for (const int threads : {1, 2}) {
    succeeds("run '{}' --occupancy-grid --grid-cell 0.2 --threads {} --out '{}'", simulated_drive(),
             threads, out.path().string());
    results.emplace_back();
    for (const char* name : {"map.pgm", "map.yaml", "trajectory.tum", "map.pcd"}) {
      results.back() += file_contents(out.file(name));
    }
  }
  CHECK(results[0].size() > 1000);
  CHECK(results[0] == results[1]);
  succeeds("run '{}' --out '{}'", simulated_drive(), out.path().string());
  CHECK_FALSE(fs::exists(out.file("map.pgm")));
  CHECK_FALSE(fs::exists(out.file("map.yaml")));
}

TEST_CASE("a band that is none is refused before anything is done") {
  const TemporaryDirectory out;
  for (const char* band : {"2,0.25", "0,2", "nan,2", "1"}) {
    CAPTURE(band);
    const ProgramResult run =
        refused(fmt::format("run '{}' --occupancy-grid --grid-band {} --out '{}'",
                            simulated_drive(), band, out.file("x")));
    CHECK_FALSE(fs::exists(out.file("x")));
  }
}

}  // namespace hqslam::test

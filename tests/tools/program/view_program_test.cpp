#include <doctest/doctest.h>
#include <fmt/format.h>

#include "tools/parts_of_text.h"
#include "tools/program/arguments.h"

namespace hqslam::test {

TEST_CASE("view shows maps, saved maps, files of points and scans of recordings, by name") {
  const TemporaryDirectory folder;
  const std::string results = folder.file("results");
  succeeds(run_arguments(results) + " --save-map --dense-map --map-voxel 0.5");
  const std::string page = folder.file("page.html");
  succeeds(
      "view '{0}/dense_map.pcd' '{0}/dense_map.ply' '{0}/map.pcd' '{0}/saved_map.npz' "
      "'{1}/bin/000000.bin' '{2}' --scan 2 --out '{3}'",
      results, simulated_drive(), short_drive(), page);
  const std::string html = file_contents(page);
  CHECK(missing(html, {R"("title":"results/dense_map.pcd")", R"("name":"results/dense_map.ply")",
                       R"("name":"results/map.pcd")", R"("name":"results/saved_map.npz")",
                       R"("name":"bin/000000.bin")"}) == "");
  CHECK(count(html, R"("sure":true)") == 2);  // of the dense maps
  CHECK(count(html, R"("origin")") == 6);
}

TEST_CASE("view refuses a scan that a recording does not have, and files without points") {
  const TemporaryDirectory folder;
  const std::string page = folder.file("page.html");
  const ProgramResult late = refused("view '{}' --scan 99 --out '{}'", short_drive(), page);
  CHECK(holds(late.error, fmt::format("expected a scan 99, found {} scans", kShortDriveScans)));
  write_file(folder.file("none.csv"), "x,y,z\n");
  CHECK(holds(refused("view '{}' --out '{}'", folder.file("none.csv"), page).error, "found none"));
  CHECK_FALSE(fs::exists(page));
}

}  // namespace hqslam::test

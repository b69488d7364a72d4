#include "tools/page_data.h"
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
  CHECK(missing(html, {R"("title":"results/dense_map.pcd and 5 more")",
                       R"("name":"results/dense_map.ply")", R"("name":"results/map.pcd")",
                       R"("name":"results/saved_map.npz")", R"("name":"bin/000000.bin")"}) == "");
  CHECK(count(html, R"("sure":true)") == 2);  // of the dense maps
  CHECK(count(html, R"("origin")") == 6);
}

TEST_CASE("view shows trajectories, aligned to the first, over a map and an occupancy grid") {
  const TemporaryDirectory folder;
  const auto path = [&](const char* name) { return folder.file(name); };
  std::string tum, kitti, late;
  for (int i = 0; i < 9; ++i) {
    tum += fmt::format("{} {} {} 0 0 0 0 1\n", 0.1 * i, i, i % 3);
    kitti += fmt::format("0 -1 0 {} 1 0 0 {} 0 0 1 7\n", -(i % 3), i);  // turned by 90 degrees
    late += fmt::format("{} {} 5 0 0 0 0 1\n", 100.0 + i, i);
  }
  write_file(path("a.tum"), tum);
  write_file(path("b.kitti"), kitti);
  write_file(path("c.txt"), late);
  write_file(path("points.txt"), "x y z\n1 2 3\n2 3 4\n");
  write_file(path("map.pgm"), "P5\n2 1\n255\n" + std::string({'\0', '\xFE'}));
  write_file(path("map.yaml"),
             "image: map.pgm\nresolution: 0.5\norigin: [1, 2, 0]\nnegate: 0\n"
             "occupied_thresh: 0.65\nfree_thresh: 0.196\n");
  const ProgramResult result = succeeds(
      "view '{0}/a.tum' '{0}/points.txt' '{0}/b.kitti' '{0}/c.txt' '{0}/map.yaml' --out "
      "'{0}/p.html'",
      folder.path());
  CHECK(holds(result.out, "b.kitti: aligned to " + path("a.tum") + ", APE RMSE 0.000 m over 9"));
  CHECK(holds(result.out, "c.txt: not aligned to"));
  CHECK(holds(result.out, "2 points, 3 trajectories"));
  const nlohmann::json data = data_of(file_contents(path("p.html")));
  const nlohmann::json& paths = data["view"]["paths"];
  REQUIRE(paths.size() == 3);
  CHECK(paths[1]["pieces"] == paths[0]["pieces"]);
  CHECK(paths[2]["pieces"][0][1] == nlohmann::json({1.0, 5.0, 0.0}));  // as it is
  CHECK(holds(paths[2]["name"].get<std::string>(), "/c.txt"));
  CHECK(data["view"]["grid"]["columns"] == 2);
  CHECK(data["view"]["clouds"].size() == 1);
  CHECK(data["notes"].size() == 2);
}

TEST_CASE("--open hands the page to xdg-open; without one, or if it fails, a line says so") {
  const TemporaryDirectory folder;
  fs::create_directory(folder.file("bin"));
  const std::string opener = folder.file("bin/xdg-open");
  write_file(folder.file("a.tum"), "0 1 2 3 0 0 0 1\n");
  const std::string page = folder.file("a page; echo.html");
  const auto opened = [&](const std::string& script) {
    fs::remove(opener);
    write_file(opener + ".new", "#!/bin/sh\n" + script);
    fs::permissions(opener + ".new", fs::perms::owner_all);
    if (!script.empty()) fs::rename(opener + ".new", opener);
    ProgramResult result =
        run_shell(fmt::format("PATH='{}' '{}' view '{}' --open --out '{}'", folder.file("bin"),
                              program_of("view"), folder.file("a.tum"), page));
    CHECK(result.status == 0);
    CHECK(fs::exists(page));
    return result;
  };
  CHECK(opened("printf %s \"$1\" >'" + folder.file("given") + "'\n").error == "");
  CHECK(file_contents(folder.file("given")) == page);
  for (const auto& [script, why] : {std::pair("exit 3\n", "exit status 3"), {"", "No such file"}}) {
    const ProgramResult failed = opened(script);
    CHECK(is_one_line(failed.error));
    CHECK(missing(failed.error, {why, page}) == "");
  }
}

TEST_CASE("view refuses a grid's image alone, two grids, scans that are not there and no points") {
  const TemporaryDirectory folder;
  write_file(folder.file("map.pgm"), "P5 1 1 255\n\xFE");
  write_file(folder.file("one.yaml"),
             "image: map.pgm\nresolution: 1\norigin: [0, 0, 0]\nnegate: 0\n"
             "occupied_thresh: 0.65\nfree_thresh: 0.196\n");
  write_file(folder.file("none.csv"), "x,y,z\n");
  for (const auto& [input, says] : std::vector<std::pair<std::string, std::string>>{
           {"'{0}/map.pgm'", "expected the .yaml file"},
           {"'{0}/one.yaml' '{0}/one.yaml'", "expected one occupancy grid"},
           {"'{1}' --scan 99", fmt::format("expected a scan 99, found {} scans", kShortDriveScans)},
           {"'{0}/none.csv'", "found none"}}) {
    const std::string command = "view " + input + " --out '{0}/page.html'";
    CHECK(holds(refused(fmt::format(fmt::runtime(command), folder.path(), short_drive())), says));
  }
  CHECK_FALSE(fs::exists(folder.file("page.html")));
}

}  // namespace hqslam::test

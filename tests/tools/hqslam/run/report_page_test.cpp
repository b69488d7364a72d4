#include "run/report_page.h"

#include <regex>

#include "program/invocation.h"
#include "tools/example_run.h"
#include "tools/page_data.h"
#include "tools/parts_of_text.h"

namespace hqslam::tools {
namespace {

/// The value of a headline number.
std::string headline(const nlohmann::json& data, const std::string& label) {
  for (const auto& number : data["numbers"]) {
    if (number["label"] == label) return number["value"];
  }
  return "";
}

}  // namespace

TEST_CASE("the headline has scans, path, error and speed") {
  const nlohmann::json data = report_json(compared_run(30, 0.5));
  CHECK(headline(data, "Scans") == "30");
  CHECK(headline(data, "Path length") == "29.0");
  CHECK_FALSE(headline(data, "Position error").empty());
  CHECK(headline(data, "Scans per second") == "50.0");
  CHECK(headline(data, "SLAM per scan") == "10.0");
}

TEST_CASE("the report says how it was made and when") {
  const char* arguments[] = {"./hqslam", "run", "my drive", "it's", "--rows=16", ""};
  keep_invocation("hqslam", 6, arguments);
  const nlohmann::json data = report_json(example_run(3));
  keep_invocation("", 0, nullptr);
  CHECK(data["command_line"] == R"(hqslam run 'my drive' 'it'\''s' --rows=16 '')");
  CHECK(std::regex_match(data["date"].get<std::string>(),
                         std::regex(R"(20\d\d-\d\d-\d\d \d\d:\d\d UTC)")));
}

TEST_CASE("every pose has its status; where the next motion is unknown is a gap and no path") {
  SlamRun run = example_run(30);
  const auto gaps = [&] {
    return std::ranges::count(numbers_of(report_json(run)["trajectory"]["gap"]), 1.0F);
  };
  CHECK(gaps() == 0);
  std::fill(run.segment_of_scan.begin() + 10, run.segment_of_scan.end(), 1);
  run.scans[20].report.mapping_status = slam::Status::kNotRecognized;
  CHECK(gaps() == 3);
  const nlohmann::json data = report_json(run);
  const auto place = std::ranges::find(data["statuses"]["names"], "not recognized") -
                     data["statuses"]["names"].begin();
  CHECK(data["statuses"]["mapping"][place] == 1);
  CHECK(numbers_of(data["trajectory"]["mapping"])[20] == static_cast<float>(place));
  CHECK(numbers_of(data["trajectory"]["mapping"])[19] == 0.0F);
  CHECK(headline(data, "Path length") == "26.0");  // of 29: one to segment 1, two about scan 20
  CHECK_FALSE(holds(data["numbers"].dump(), "not joined"));
  run.submap_of_scan = run.segment_of_scan;
  CHECK(gaps() == 3);
  CHECK(holds(report_json(run)["numbers"].dump(), "2 submaps not joined"));
}

TEST_CASE("standard deviations of a pose are those of its covariance, rotations in degrees") {
  SlamRun run = example_run(3);
  run.scans[1].report.covariance.setZero();
  run.scans[1].report.covariance(1, 1) = 0.04;
  run.scans[1].report.covariance(5, 5) = std::pow(M_PI / 180.0, 2);
  const nlohmann::json sigma = report_json(run)["trajectory"]["sigma"];
  CHECK(numbers_of(sigma[1])[1] == doctest::Approx(0.2));
  CHECK(numbers_of(sigma[5])[1] == doctest::Approx(1.0));
  CHECK(numbers_of(sigma[0])[1] == 0.0F);
}

TEST_CASE("a run that ended early gives the reason, one without a single scan still makes a page") {
  SlamRun run = example_run(3);
  run.end = ReadingEnd::kUnreadableScan;
  run.end_message = "<000003.bin>: truncated";
  const nlohmann::json early = data_of(report_html(run));
  CHECK(holds(early["notices"][0].get<std::string>(), "<000003.bin>: truncated"));
  run = example_run(0);
  run.end = ReadingEnd::kInterrupted;
  const nlohmann::json empty = data_of(report_html(run));
  CHECK(empty["trajectory"]["scan"].empty());
  CHECK_FALSE(empty.contains("error"));
}

TEST_CASE("the page of a long run has some 100 bytes for each scan") {
  CHECK(report_html(example_run(8000)).size() < 1'200'000);
}

TEST_CASE("with a reference each pose has its error, and the reference is in the map frame") {
  const nlohmann::json data = report_json(compared_run(30, 2.0));
  const std::vector<float> error_m = numbers_of(data["trajectory"]["error_m"]);
  REQUIRE(error_m.size() == 30);
  CHECK(*std::ranges::max_element(error_m) ==
        doctest::Approx(data["trajectory"]["largest_error_m"].get<double>()));
  CHECK(numbers_of(data["error"]["translation_m"]).size() == 30);

  const nlohmann::json exact = report_json(compared_run(30, 0.0));  // in another frame
  const std::vector<float> x_m = numbers_of(exact["trajectory"]["x"]);
  const std::vector<float> reference_x_m = numbers_of(exact["reference"]["x"]);
  REQUIRE(reference_x_m.size() == x_m.size());
  for (std::size_t i = 0; i < x_m.size(); ++i) {
    CHECK(std::abs(reference_x_m[i] - x_m[i]) < 1e-3);
  }
  CHECK_FALSE(report_json(example_run(30)).contains("reference"));
}

TEST_CASE("an occupancy grid is packed into two bits a cell") {
  slam::OccupancyMap map{0.1, {1.0, 2.0}, 2, 3, {}};
  using enum slam::Occupancy;
  map.cells = {kUnknown, kFree, kOccupied, kOccupied, kUnknown, kFree};
  const nlohmann::json grid = report_json(example_run(3), nullptr, &map)["view"]["grid"];
  CHECK(grid["rows"] == 2);
  CHECK(grid["columns"] == 3);
  CHECK(numbers_of(grid["cells"]) == std::vector<float>{0b10100100, 0b0100});
}

TEST_CASE("a scan of a view has the pose of a neighbour, to which the motion is known") {
  SlamRun run = example_run(4);
  for (std::size_t pose = 0; pose < 4; ++pose) run.kept_scans.push_back({pose, {7}, {0.0F}});
  std::fill(run.segment_of_scan.begin() + 3, run.segment_of_scan.end(), 1);
  const TurningView view = view_of(run);
  REQUIRE(view.drive.scans.size() == 4);
  CHECK(view.drive.scans[1].name == "scan 0, 0.1 s");
  CHECK(view.drive.scans[1].range[0] == 7);
  CHECK(view.drive.scans[1].T_map_sensor.translation().x() == 1.0);
  const auto checks = [&](std::size_t scan, double other_x_m, double other_s) {
    CHECK(view.drive.scans[scan].T_map_other.translation().x() == other_x_m);
    CHECK(view.drive.scans[scan].other_s == doctest::Approx(other_s));
  };
  checks(1, 2.0, 0.1);
  checks(2, 1.0, -0.1);
  checks(3, 3.0, 0.0);
  run.submap_of_scan = run.segment_of_scan;
  CHECK(view_of(run).drive.scans.size() == 3);
}

TEST_CASE("the path ends where the relative pose is unknown, and other submaps are not shown") {
  SlamRun run = example_run(30);
  run.loops.push_back({slam::LoopStatus::kClosed, 1, 20, 2, 0.5});
  CHECK(view_of(run).paths[0].pieces_m.size() == 1);
  CHECK(view_of(run).loops_m.size() == 1);
  std::fill(run.segment_of_scan.begin() + 10, run.segment_of_scan.end(), 1);
  const TurningView joined = view_of(run);
  REQUIRE(joined.paths[0].pieces_m.size() == 2);
  CHECK(joined.paths[0].pieces_m[0].size() == 10);
  run.submap_of_scan = run.segment_of_scan;
  const TurningView parted = view_of(run);
  CHECK(parted.paths[0].pieces_m.size() == 1);
  CHECK(parted.loops_m.empty());
}

TEST_CASE("the dense map comes first, with its confidence") {
  DenseMapRun map;
  map.points = {{{1.0F, 2.0F, 3.0F}, 0.7F, 2}};
  const TurningView view = view_of(example_run(3), &map);
  REQUIRE(view.clouds.size() == 2);
  CHECK(view.clouds[0].confidence == std::vector<float>{0.7F});
  CHECK(view.clouds[1].points_m.size() == 3);
}

}  // namespace hqslam::tools

#include <doctest/doctest.h>

#include <filesystem>
#include <functional>
#include <vector>

#include "file_contents.h"
#include "table/table_figures.h"
#include "temporary_directory.h"
#include "tools/example_table.h"

namespace hqslam::tools {
namespace {

using test::example_result;

/// A folder with the result of "du-or".
struct SavedResult {
  SavedResult() { save_result(result, folder.path().string()); }
  std::optional<TableResult> loaded() const {
    return load_result(result.settings, folder.path().string());
  }
  test::TemporaryDirectory folder;
  TableResult result = with_left_out(example_result(table_methods()[7], 0.5));

 private:
  static TableResult with_left_out(TableResult result) {
    result.scan_of_pose = {0, 1, 4};
    result.left_out.scans = 2;
    result.left_out.first = "scan 7: expected something else";
    return result;
  }
};

}  // namespace

TEST_CASE("a result that was written is read back, figures, times and trajectories") {
  const SavedResult saved;
  const std::optional<TableResult> read = saved.loaded();
  REQUIRE(read);
  CHECK(read->settings == saved.result.settings);
  CHECK(read->images->mae_all_m == 2.5);
  CHECK(read->images->mae_valid_m == 0.25);
  CHECK(read->images->outlier_share == 0.0625);
  CHECK(read->images->scans == 40);
  CHECK(read->network->parameters == 175000);
  CHECK(read->network->multiply_adds == 367000000);
  CHECK(read->loops_closed == 3);
  CHECK(read->scan_of_pose == std::vector<std::int64_t>{0, 1, 4});
  CHECK(read->left_out.scans == 2);
  CHECK(read->left_out.first == "scan 7: expected something else");
  CHECK(read->timings.upsampling_s == 0.2);
  CHECK(read->timings.upsampling_ms == 4.0);
  CHECK(read->timings.points_s == 0.2);
  CHECK(read->timings.slam[0].total_s == 0.4);
  CHECK(read->timings.slam[0].last_ms == 11.0);
  CHECK_FALSE(read->timings.slam[1].first_ms);
  for (std::size_t i = 0; i < 2; ++i) {
    REQUIRE(read->trajectory[i].size() == 40);
    CHECK(read->trajectory[i][7].T_map_sensor.isApprox(saved.result.trajectory[i][7].T_map_sensor,
                                                       1e-9));
  }
}

TEST_CASE("a method without images and network is read back without") {
  const test::TemporaryDirectory folder;
  const TableResult result = example_result(table_methods()[0], 0.5);
  save_result(result, folder.file("new/folder"));
  const std::optional<TableResult> read = load_result(result.settings, folder.file("new/folder"));
  REQUIRE(read);
  CHECK_FALSE(read->images);
  CHECK_FALSE(read->network);
}

TEST_CASE("a result without loop closing is read back without its trajectory") {
  const test::TemporaryDirectory folder;
  TableResult result = example_result(table_methods()[0], 0.5);
  result.settings.loop_closing = false;
  result.trajectory[kLoopClosingOn].clear();
  save_result(result, folder.path().string());
  const std::optional<TableResult> read = load_result(result.settings, folder.path().string());
  REQUIRE(read);
  CHECK(read->trajectory[kLoopClosingOff].size() == 40);
  CHECK(read->trajectory[kLoopClosingOn].empty());
}

TEST_CASE("a result of other settings is not used, whichever differs") {
  const SavedResult saved;
  const std::vector<std::function<void(TableSettings&)>> changes = {
      [](TableSettings& s) { s.build = "build 2"; },
      [](TableSettings& s) { s.recording = "another drive"; },
      [](TableSettings& s) { s.sensor = "os1-64 1"; },
      [](TableSettings& s) { s.scans = 39; },
      [](TableSettings& s) { s.loop_closing = false; },
      [](TableSettings& s) { s.method = "du-or-no-filter"; },
      [](TableSettings& s) { s.weights = "other.npz"; },
      [](TableSettings& s) { s.weights_hash = "18"; },
  };
  for (const auto& change : changes) {
    TableSettings settings = saved.result.settings;
    change(settings);
    CHECK_FALSE(load_result(settings, saved.folder.path().string()));
  }
  CHECK(saved.loaded());
}

TEST_CASE("a result of the same name with other settings inside is not used") {
  const SavedResult saved;
  TableResult other = saved.result;
  other.settings.scans = 39;
  save_result(other, saved.folder.path().string());
  CHECK_FALSE(saved.loaded());
}

TEST_CASE("a damaged or missing file means that there is no result") {
  for (const char* file :
       {"du-or.json", "du-or-loop-closing-off.tum", "du-or-loop-closing-on.tum"}) {
    CAPTURE(file);
    const SavedResult saved;
    const std::string path = saved.folder.file(file);
    const std::string whole = test::file_contents(path);
    REQUIRE(whole.size() > 100);
    test::write_file(path, whole.substr(0, whole.size() / 2));
    CHECK_FALSE(saved.loaded());
    test::write_file(path, "{\"written_by\": 3}");
    CHECK_FALSE(saved.loaded());
    std::filesystem::remove(path);
    CHECK_FALSE(saved.loaded());
    test::write_file(path, whole);
    CHECK(saved.loaded());
  }
}

TEST_CASE("one digit changed in a trajectory is noticed") {
  const SavedResult saved;
  const std::string path = saved.folder.file("du-or-loop-closing-on.tum");
  std::string text = test::file_contents(path);
  char& digit = text[text.find("0.") + 4];
  digit = digit == '1' ? '2' : '1';
  test::write_file(path, text);
  CHECK_FALSE(saved.loaded());
}

}  // namespace hqslam::tools

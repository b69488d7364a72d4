#include <doctest/doctest.h>
#include <fmt/format.h>
#include <signal.h>

#include <algorithm>
#include <filesystem>
#include <vector>

#include "golden_folder.h"
#include "hqslam/core/trajectory.h"
#include "tools/program/child.h"
#include "tools/program/program.h"

namespace hqslam::test {
namespace {

constexpr const char* kMethods = "rows-16,linear,du-or,rows-64";

ProgramResult make_table(const std::string& out) {
  return run_hqslam("table --drives block --scans 16 --methods {} --out '{}'", kMethods, out);
}

/// The folder of the only results in results/DRIVE with so many scans, "" if there is none yet.
std::string results_folder(const std::string& out, const std::string& drive, int scans) {
  const fs::path folder = fs::path(out) / "results" / drive;
  if (!fs::is_directory(folder)) return "";
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (name.rfind(std::to_string(scans) + "-scans-build-", 0) == 0) {
      return entry.path().string() + "/";
    }
  }
  return "";
}

/// Starts the same table and stops it with Ctrl-C once a method's result is there. Returns its exit
/// status.
int interrupted_table(const std::string& out, const std::string& method) {
  Child child(
      fmt::format("table --drives block --scans 16 --methods {} --out '{}'", kMethods, out));
  // The folder's name is known once it is there; the table may end by itself.
  const bool is_there = child.wait_until(
      [&] { return fs::exists(results_folder(out, "block-typical", 16) + method + ".json"); });
  return is_there ? child.end(SIGINT) : -1;
}

/// The number after `label` in a program's output.
double number_after(const std::string& text, const std::string& label) {
  return std::stod(text.substr(text.find(label) + label.size()));
}

/// APE RMSE of `hqslam run` with these arguments, as `hqslam evaluate` prints it.
double evaluated_ape_m(const std::string& arguments, const std::string& out,
                       const std::string& reference) {
  succeeds("run {} --out '{}'", arguments, out);
  return number_after(run_hqslam("evaluate '{}/trajectory.tum' '{}'", out, reference).out,
                      "APE m (align se3)");
}

}  // namespace

TEST_CASE("a table is interrupted, finished, repeated and repaired, always with the same figures") {
  const TemporaryDirectory folder;
  const std::string out = folder.file("table");
  CHECK(interrupted_table(out, "rows-64") == 130);
  const std::string results = results_folder(out, "block-typical", 16);
  REQUIRE_FALSE(results.empty());
  CHECK(holds(file_contents(out + "/table.md"), "| LiDAR-64 |"));
  CHECK_FALSE(holds(file_contents(out + "/table.md"), "| DU-OR |"));
  const std::string first = file_contents(results + "rows-64.json");

  const ProgramResult finished = make_table(out);
  CAPTURE(finished.error);
  REQUIRE(finished.status == 0);
  CHECK(file_contents(results + "rows-64.json") == first);  // with its times: it was not run again
  for (const char* row : {"LiDAR-16 ", "linear ", "DU-OR ", "LiDAR-64 "}) {
    CAPTURE(row);
    CHECK(holds(finished.out, fmt::format("\n{}", row)));
    CHECK(holds(file_contents(out + "/table.md"), fmt::format("| {}|", row)));
  }
  CHECK(fs::file_size(out + "/table.html") > 1000);
  const nlohmann::json table = json_of(out + "/table.json");
  const nlohmann::json& methods = table["drives"][0]["methods"];
  REQUIRE(methods.size() == 4);

  // The figures are those of run and evaluate.
  const std::string drive = out + "/drives/block-typical";
  const std::string weights = golden_folder() + "/../../weights/du-or_os1_16to64.npz";
  const std::string arguments = fmt::format("'{}' --upsample '{}'", drive, weights);
  const nlohmann::json& du_or = methods[2]["loop_closing_off"];
  CHECK(evaluated_ape_m(arguments, folder.file("run"), drive + "/truth.tum") ==
        doctest::Approx(du_or["against_truth"]["ape_rmse_m"].get<double>()).epsilon(0.01));
  CHECK(file_contents(folder.file("run/trajectory.tum")) ==
        file_contents(results + "du-or-loop-closing-off.tum"));

  // Repeated: everything is there. Repaired: the damaged one is computed anew.
  const std::string whole = file_contents(out + "/table.json");
  const ProgramResult repeated = make_table(out);
  CHECK(repeated.error.empty());
  CHECK(file_contents(out + "/table.json") == whole);
  write_file(results + "linear.json", "{\"written_by\": \"hqsl");
  const ProgramResult repaired = make_table(out);
  CHECK(repaired.status == 0);
  CHECK(holds(repaired.error, "block-typical, linear: 16/16 scans"));
  CHECK(json_of(out + "/table.json")["drives"] == table["drives"]);
}

TEST_CASE(
    "methods that share a network's pass give what each gives alone, and length is a setting") {
  const TemporaryDirectory folder;
  const std::string drive = simulated_drive("--sensor os1-64 --scans 6");
  const auto run_with = [&](const std::string& methods, const std::string& out) {
    succeeds("table --drives '{}' --scans 4 --methods {} --out '{}'", drive, methods, out);
  };
  run_with("du-or-no-filter,du-or,du-or+computed-rows", folder.file("shared"));
  run_with("du-or-no-filter", folder.file("alone"));
  const nlohmann::json both = json_of(folder.file("shared/table.json"))["drives"][0];
  CHECK(both["scans"] == 4);
  CHECK(both["methods"][0] == json_of(folder.file("alone/table.json"))["drives"][0]["methods"][0]);
  CHECK(both["methods"][1]["images"]["outlier_share"] <
        both["methods"][0]["images"]["outlier_share"].get<double>());

  // A variant of SLAM sees the same images, but goes another way.
  CHECK(both["methods"][2]["images"] == both["methods"][1]["images"]);
  const std::string results =
      results_folder(folder.file("shared"), fs::path(drive).filename().string(), 4);
  CHECK(file_contents(results + "du-or+computed-rows-loop-closing-off.tum") !=
        file_contents(results + "du-or-loop-closing-off.tum"));
}

TEST_CASE("a drive that was simulated once serves shorter tables too") {
  const TemporaryDirectory folder;
  const auto rows_of = [&](int scans, const std::string& out) {
    succeeds("table --drives block,handheld --scans {} --methods rows-16 --out '{}'", scans,
             folder.file(out));
    return json_of(folder.file(out) + "/table.json")["drives"];
  };
  rows_of(6, "long");
  const nlohmann::json shortened = rows_of(4, "long");
  for (const char* drive : {"block", "handheld"}) {  // not made anew
    CHECK(json_of(folder.file(fmt::format("long/drives/{}-typical/drive.json", drive)))["scans"] ==
          6);
  }
  CHECK(shortened[0]["scans"] == 4);
  CHECK(shortened == rows_of(4, "short"));

  // The longer table's results are still there: nothing is left to do.
  const ProgramResult again =
      run_hqslam("table --drives block,handheld --scans 6 --methods rows-16 --out '" +
                 folder.file("long") + "'");
  CHECK(again.error.empty());
  CHECK(json_of(folder.file("long/table.json"))["drives"][0]["scans"] == 6);
}

TEST_CASE("a simulated drive that was damaged is simulated again with a warning") {
  const TemporaryDirectory folder;
  const std::string out = folder.file("out");
  const std::string arguments =
      "table --drives block --scans 3 --methods rows-16 --out '" + out + "'";
  succeeds(arguments);
  const std::string scans = file_contents(out + "/drives/block-typical/scans.npy");
  for (const auto& [file, damaged] : std::vector<std::pair<const char*, std::string>>{
           {"drive.json", "{\"name\": "},
           {"sensor.json", "damaged"},
           {"drive.json", std::string(2 << 16, 'x')},
           {"scans.npy", std::string(scans.size(), '\0')},
           {"scans.npy", scans.substr(0, 200) + std::string(scans.size() - 200, '\0')},
           {"truth.tum", ""}}) {
    CAPTURE(file);
    write_file(out + "/drives/block-typical/" + file, damaged);
    const ProgramResult result = succeeds(arguments);
    CHECK(missing(result.error, {"drives/block-typical: ", "the drive is simulated again"}) == "");
    CHECK(file_contents(out + "/drives/block-typical/scans.npy") == scans);
  }
}

TEST_CASE("other scans at the same place are not given the results of those before") {
  const TemporaryDirectory folder;
  const std::string drive = folder.file("drive");
  const auto path_of = [&](const std::string& seed) {
    fs::remove_all(drive);
    // Long enough to set out: the drive begins standing.
    run_hqslam("simulate --drive block --sensor os1-64 --scans 16 --seed " + seed + " --out '" +
               drive + "'");
    succeeds("table --drives '" + drive + "' --methods rows-16 --out '" + folder.file("out") + "'");
    return json_of(folder.file(
        "out/table.json"))["drives"][0]["methods"][0]["loop_closing_off"]["against_truth"]["path_m"]
        .get<double>();
  };
  CHECK(path_of("1") != path_of("2"));
}

TEST_CASE("over seeds drives run side by side with the same figures as one by one, and go on") {
  const TemporaryDirectory folder;
  const auto table = [&](const std::string& seeds, int threads, const std::string& out) {
    succeeds(
        "table --drives block --seeds {} --scans 20 --methods "
        "rows-16,linear --threads {} --out '{}'",
        seeds, threads, folder.file(out));
    nlohmann::json json = json_of(folder.file(out) + "/table.json");
    for (nlohmann::json& method : json["methods"]) {
      for (const char* part : {"all", "block"}) method[part].erase("slam_ms");
    }
    return json;
  };
  const nlohmann::json together = table("5,6", 2, "together");
  REQUIRE(together["drives"].size() == 2);
  CHECK(together == table("5,6", 1, "alone"));
  CHECK(together["drives"][0]["path_m"] != together["drives"][1]["path_m"]);
  CHECK(holds(file_contents(folder.file("together/table.html")), "seeds 5, 6"));

  // More seeds: what is there stays as it was, with its times.
  const std::string before = file_contents(
      results_folder(folder.file("together"), "block-seed-5-typical", 20) + "linear.json");
  const nlohmann::json more = table("5..7", 2, "together");
  CHECK(more["drives"].size() == 3);
  CHECK(more["drives"][0] == together["drives"][0]);
  CHECK(file_contents(results_folder(folder.file("together"), "block-seed-5-typical", 20) +
                      "linear.json") == before);
}

TEST_CASE("over seeds drives too short for any figure are refused, not passed over in silence") {
  const TemporaryDirectory folder;
  const ProgramResult result = run_hqslam(
      "table --drives block --seeds 1 --scans 2 --methods rows-16 --out '{}'", folder.file("out"));
  CHECK(result.status == 2);
  CHECK(holds(result.error, "--scans"));
}

TEST_CASE(
    "scans that cannot be understood are left out of a table, which says how many they were") {
  const TemporaryDirectory folder;
  const std::string bins = folder.file("bin");
  fs::copy(simulated_drive("--sensor os1-64 --scans 6") + "/bin", bins);
  std::vector<fs::path> files(fs::directory_iterator(bins), {});
  std::ranges::sort(files);
  const std::string arguments =
      fmt::format("table --drives '{}' --sensor os1-64 --methods rows-16,linear --out '{}'", bins,
                  folder.file("out"));
  for (const std::size_t damaged : {2, 4}) fs::resize_file(files[damaged], 1001);
  for (const char* time : {"computed", "there already"}) {
    CAPTURE(time);
    const ProgramResult result = succeeds(arguments);
    CHECK(missing(result.error, {"hqslam-lab: bin: 2 scans were left out, the first of them: ",
                                 files[2].filename().string()}) == "");
  }
  for (const char* page : {"table.md", "table.html"}) {
    CHECK(holds(file_contents(folder.file("out/") + page), "2 scans were left out"));
  }
  CHECK(json_of(folder.file("out/table.json"))["drives"][0]["scans_left_out"] == 2);
  const std::string results = results_folder(folder.file("out"), "bin", 6);
  CHECK(read_tum(results + "linear-loop-closing-off.tum").size() == 4);

  for (const fs::path& file : files) fs::resize_file(file, 1001);
  CHECK(holds(refused(arguments).error, ".bin: expected a KITTI scan"));
}

TEST_CASE("a table reads scans that change places in the order of their stamps") {
  const TemporaryDirectory folder;
  write_file(folder.file("stamps.txt"), "0\n0.1\n0.2\n0.15\n");
  succeeds(
      "table --drives '{1}/bin' --sensor os1-64 --methods rows-16 --stamps '{0}/stamps.txt' --out "
      "'{0}/out'",
      folder.path().string(), simulated_drive("--sensor os1-64 --scans 4"));
  const Trajectory found =
      read_tum(results_folder(folder.file("out"), "bin", 4) + "rows-16-loop-closing-off.tum");
  REQUIRE(found.size() == 4);
  CHECK(found[2].stamp_s == doctest::Approx(0.15));
  CHECK(found[3].stamp_s == doctest::Approx(0.2));
}

TEST_CASE("networks that others published are rows of a table") {
  const TemporaryDirectory folder;
  const ProgramResult result =
      succeeds("table --drives '{}' --methods rows-64 --weights '{}' --out '{}'",
               simulated_drive("--sensor os1-64 --scans 4"),
               golden_folder() + "/../../weights/srae_4_os1_16to64.npz", folder.file("out"));
  CHECK(holds(result.out, "srae_4_os1_16to64"));
}

TEST_CASE("a wrong table is one line on stderr and status 2, and writes nothing") {
  const TemporaryDirectory folder;
  const std::string out = folder.file("out");
  const std::string drive = simulated_drive();  // 16 rows
  for (const std::string& arguments : {
           "--drives block --methods rows-16 --weights '" + golden_folder() +
               "/../../weights/du-mix_hdl64e_16to64.npz'",
           "--drives '" + drive + "'",
           "--drives '" + drive + "/bin' --sensor os1-16",
           std::string("--drives block --scans 0"),
       }) {
    CAPTURE(arguments);
    refused("table " + arguments + " --out '" + out + "'");
    CHECK_FALSE(fs::exists(out));
  }
}

}  // namespace hqslam::test

#include "golden_folder.h"
#include "tools/program/child.h"

namespace hqslam::test {
namespace {

/// The file of a method's only run on a drive; "" before it.
std::string run_file(const std::string& out, const std::string& drive, const std::string& method) {
  const fs::path folder = fs::path(out) / "results" / drive;
  if (!fs::is_directory(folder)) return "";
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    // METHOD-KEY.tum; of du-or no file of du-or-no-filter.
    constexpr std::size_t kKeyDigits = 16;
    const bool has_key = name.size() == method.size() + 1 + kKeyDigits + 4;
    if (has_key && name.starts_with(method + "-") && name.ends_with(".tum")) {
      return entry.path().string();
    }
  }
  return "";
}

}  // namespace

TEST_CASE("a table is interrupted, finished, repeated and repaired, always with the same figures") {
  const TemporaryDirectory folder;
  const std::string out = folder.file("table");
  const std::string arguments =
      "table --drives block --scans 16 --methods rows-16,linear,du-or,rows-64 --out '" + out + "'";
  const auto rows_16 = [&] { return run_file(out, "block-typical", "rows-16"); };
  {
    Child child(arguments);
    CHECK(child.wait_until([&] { return !rows_16().empty(); }));
    CHECK(child.end(SIGINT) == 130);
  }
  const std::string first = rows_16();
  REQUIRE_FALSE(first.empty());
  const auto written = fs::last_write_time(first);

  const ProgramResult finished = run_hqslam(arguments);
  CAPTURE(finished.error);
  REQUIRE(finished.status == 0);
  CHECK(fs::last_write_time(first) == written);  // it was not run again
  for (const char* row : {"LiDAR-16 ", "linear ", "DU-OR ", "LiDAR-64 "}) {
    CAPTURE(row);
    CHECK(holds(finished.out, fmt::format("\n{}", row)));
    CHECK(holds(file_contents(out + "/table.md"), fmt::format("| {}|", row)));
  }
  CHECK(fs::file_size(out + "/table.html") > 1000);
  const nlohmann::json table = json_of(out + "/table.json");
  REQUIRE(table["methods"].size() == 4);

  // The figures are those of run and evaluate.
  const std::string drive = out + "/drives/block-typical";
  const std::string weights = golden_folder() + "/../../weights/du-or_os1_16to64.npz";
  const std::string run = folder.file("run");
  succeeds("run '{}' --upsample '{}' --no-loop-closing --out '{}'", drive, weights, run);
  const std::string ape = "APE m (align se3)";
  const std::string evaluated =
      succeeds("evaluate '{}/trajectory.tum' '{}/truth.tum'", run, drive).out;
  const nlohmann::json& du_or = table["methods"][2]["block-typical against the truth"];
  CHECK(std::stod(evaluated.substr(evaluated.find(ape) + ape.size())) ==
        doctest::Approx(du_or["ape_m"]["value"].get<double>()).epsilon(0.01));
  CHECK(file_contents(folder.file("run/trajectory.tum")) ==
        file_contents(run_file(out, "block-typical", "du-or")));

  // Repeated: everything is there. Repaired: the damaged one is computed anew.
  const std::string whole = file_contents(out + "/table.json");
  CHECK(run_hqslam(arguments).error.empty());
  CHECK(file_contents(out + "/table.json") == whole);
  write_file(run_file(out, "block-typical", "linear"), "0.05 1");
  const ProgramResult repaired = run_hqslam(arguments);
  CHECK(repaired.status == 0);
  CHECK(holds(repaired.error, "block-typical, linear: 16/16 scans"));
  CHECK(file_contents(out + "/table.json") == whole);
}

TEST_CASE("LeGO-LOAM, networks without their filter and those of others go other ways") {
  const TemporaryDirectory folder;
  const std::string drive = simulated_drive("--sensor os1-64 --scans 6");
  const std::string out = folder.file("out");
  const ProgramResult table =
      succeeds("table --drives '{}' --scans 4 --methods {} --weights '{}' --out '{}'", drive,
               "du-or-no-filter,du-or,du-or+as-published,rows-64",
               golden_folder() + "/../../weights/srae_4_os1_16to64.npz", out);
  CHECK(holds(table.out, "srae_4_os1_16to64"));
  const std::string name = fs::path(drive).filename().string();
  const std::string du_or = file_contents(run_file(out, name, "du-or"));
  CHECK(read_tum(run_file(out, name, "du-or")).size() == 4);
  CHECK(file_contents(run_file(out, name, "du-or-no-filter")) != du_or);
  CHECK(file_contents(run_file(out, name, "du-or+as-published")) != du_or);
}

TEST_CASE("a drive that was simulated once serves shorter tables too") {
  const TemporaryDirectory folder;
  const auto drives_of = [&](int scans, const std::string& out) {
    succeeds("table --drives block --scans {} --methods rows-16 --out '{}'", scans,
             folder.file(out));
    return json_of(folder.file(out) + "/table.json")["drives"];
  };
  drives_of(6, "long");
  const nlohmann::json shortened = drives_of(4, "long");
  CHECK(json_of(folder.file("long/drives/block-typical/drive.json"))["scans"] == 6);  // as it was
  CHECK(shortened[0]["scans"] == 4);
  CHECK(shortened == drives_of(4, "short"));

  // The longer table's runs are still there: nothing is left to do.
  CHECK(
      run_hqslam("table --drives block --scans 6 --methods rows-16 --out '{}'", folder.file("long"))
          .error.empty());
  CHECK(json_of(folder.file("long/table.json"))["drives"][0]["scans"] == 6);
}

TEST_CASE("a simulated drive that is not complete is simulated again") {
  const TemporaryDirectory folder;
  const std::string out = folder.file("out");
  const auto arguments = "table --drives block --scans 3 --methods rows-16 --out '" + out + "'";
  succeeds(arguments);
  const std::string scans = file_contents(out + "/drives/block-typical/scans.npy");
  for (const auto& [file, damaged] : std::vector<std::pair<const char*, std::string>>{
           {"scans.npy", std::string(scans.size(), '\0')},
           {"scans.npy", scans.substr(0, 200)},
           {"truth.tum", ""}}) {
    CAPTURE(file);
    write_file(out + "/drives/block-typical/" + file, damaged);
    succeeds(arguments);
    CHECK(file_contents(out + "/drives/block-typical/scans.npy") == scans);
  }
}

TEST_CASE("over seeds drives run side by side with the same figures as one by one, and go on") {
  const TemporaryDirectory folder;
  const auto table = [&](const std::string& seeds, int threads, const std::string& out) {
    succeeds(
        "table --drives block --seeds {} --scans 20 --methods "
        "rows-16,linear --threads {} --out '{}'",
        seeds, threads, folder.file(out));
    return json_of(folder.file(out) + "/table.json");
  };
  const nlohmann::json together = table("5,6", 2, "together");
  REQUIRE(together["drives"].size() == 2);
  CHECK(together == table("5,6", 1, "alone"));
  CHECK(together["drives"][0]["path_m"] != together["drives"][1]["path_m"]);
  CHECK(holds(file_contents(folder.file("together/table.html")), "seeds 5, 6"));

  // More seeds: what is there stays as it was.
  const std::string run = run_file(folder.file("together"), "block-seed-5-typical", "linear");
  const auto written = fs::last_write_time(run);
  const nlohmann::json more = table("5..7", 2, "together");
  CHECK(more["drives"].size() == 3);
  CHECK(more["drives"][0] == together["drives"][0]);
  CHECK(fs::last_write_time(run) == written);
}

TEST_CASE("over seeds drives too short for any figure are refused, not passed over in silence") {
  const TemporaryDirectory folder;
  const char* const two_scans = "table --drives block --seeds 1 --scans 2 --methods rows-16";
  CHECK(holds(refusal(run_hqslam("{} --out '{}'", two_scans, folder.file("out"))), "--scans"));
}

TEST_CASE("scans that cannot be understood are left out of a table, which says how many") {
  const TemporaryDirectory folder;
  const std::string bins = folder.file("bin");
  fs::copy(simulated_drive("--sensor os1-64 --scans 6") + "/bin", bins);
  std::vector<fs::path> files(fs::directory_iterator(bins), {});
  std::ranges::sort(files);
  const std::string arguments =
      fmt::format("table --drives '{}' --sensor os1-64 --methods rows-16,rows-64 --out '{}'", bins,
                  folder.file("out"));
  for (const std::size_t damaged : {2, 4}) fs::resize_file(files[damaged], 1001);
  CHECK(missing(succeeds(arguments).error,
                {"hqslam-lab: bin: 2 scans were left out, the first of them: ",
                 files[2].filename().string()}) == "");
  for (const char* page : {"table.md", "table.html"}) {
    CHECK(holds(file_contents(folder.file("out/") + page), "of which 2 were left out"));
  }
  CHECK(json_of(folder.file("out/table.json"))["drives"][0]["scans_left_out"] == 2);
  CHECK(read_tum(run_file(folder.file("out"), "bin", "rows-16")).size() == 4);

  for (const fs::path& file : files) fs::resize_file(file, 1001);
  CHECK(holds(refused(arguments), ".bin: expected a KITTI scan"));
}

TEST_CASE("a wrong table is one line on stderr and status 2, and writes nothing") {
  const TemporaryDirectory folder;
  const std::string out = folder.file("out");
  const std::string drive = simulated_drive();  // 16 rows
  for (const std::string& arguments : {
           "--drives block --methods rows-16 --weights '" + golden_folder() +
               "/../../weights/du-or_hdl64e_16to64.npz'",
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

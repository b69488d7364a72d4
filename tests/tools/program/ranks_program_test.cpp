#include <doctest/doctest.h>
#include <fmt/format.h>

#include <filesystem>

#include "tools/program/program.h"

// The program as one of several that mpirun starts.

namespace hqslam::test {
namespace {

/// Where mpirun is; "" and a message where the program was built without MPI.
std::string mpirun() {
  const std::string path = HQSLAM_MPIRUN;
  if (path.empty()) MESSAGE("SKIPPED: many processes (there is no MPI)");
  return path;
}

/// The command that starts so many: on two cores or on one, as root of a container or not, over
/// nothing but shared memory.
std::string on_ranks(int count) {
  return fmt::format(
      "env OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_btl=self,vader "
      "OMPI_MCA_rmaps_base_oversubscribe=1 OMPI_MCA_hwloc_base_binding_policy=none "
      "OMPI_MCA_mpi_yield_when_idle=1 ASAN_OPTIONS=detect_leaks=0 '{}' -n {} '{}'",
      mpirun(), count, HQSLAM_LAB_PROGRAM);
}

ProgramResult run_on_ranks(int count, const std::string& arguments) {
  return run_shell(on_ranks(count) + " " + arguments);
}

std::string recipe(int batch) {
  return fmt::format(R"({{
    "network": {{"kind": "du-or", "layers": 2, "sensor": "os1-64", "measured_rows": 16,
                "denoiser": {{"channels": [8, 8], "memory": 2}}}},
    "training": [{{"drive": "block", "seeds": [5, 7], "scans": 4, "every": 2}}],
    "validation": [{{"drive": "block", "seeds": [6], "scans": 1}}],
    "steps": 6, "batch": {}, "augmentation": {{"crop_columns": 64}}, "validate_every": 3
  }})",
                     batch);
}

}  // namespace

TEST_CASE("two processes train the same bytes as one, and one of them speaks") {
  if (mpirun().empty()) return;
  for (const int batch : {2, 4}) {
    CAPTURE(batch);
    const TemporaryDirectory folder;
    write_file(folder.file("recipe.json"), recipe(batch));
    const auto arguments = [&](const std::string& name) {
      return fmt::format("train --config '{0}/recipe.json' --out '{0}/{1}'", folder.path().string(),
                         name);
    };
    succeeds(arguments("one"));
    const ProgramResult two = run_on_ranks(2, arguments("two"));
    CAPTURE(two.error);
    CHECK(two.status == 0);
    CHECK(count(two.out, "from step 0") == 1);
    CHECK(count(two.out, "step       6/6") == 1);
    for (const char* name : {"/weights.npz", "/checkpoint.npz", "/curve.json"}) {
      CAPTURE(name);
      CHECK(file_contents(folder.file("two") + name) == file_contents(folder.file("one") + name));
    }
    for (const fs::directory_entry& drive : fs::directory_iterator(folder.file("one/drives"))) {
      CHECK(file_contents(folder.file("two/drives/") + drive.path().filename().string()) ==
            file_contents(drive.path().string()));
    }
  }
}

TEST_CASE("a training that two processes began and one ended has the bytes of one") {
  if (mpirun().empty()) return;
  const TemporaryDirectory folder;
  const std::string six = "\"steps\": 6";
  std::string text = recipe(2);
  text.replace(text.find(six), six.size(), "\"steps\": 200");
  write_file(folder.file("recipe.json"), text);
  const std::string arguments = fmt::format(
      "train --config '{0}/recipe.json' --drives '{0}/drives' --out '{0}/", folder.path().string());
  succeeds(arguments + "whole'");
  const ProgramResult stopped =
      run_shell(fmt::format("{} {}parts' & pid=$!\n"
                            "while [ ! -e '{}' ] && kill -0 $pid; do sleep 0.01; done\n"
                            "kill -TERM $pid; wait $pid",
                            on_ranks(2), arguments, folder.file("parts/checkpoint.npz")));
  CHECK(stopped.status != 0);
  CHECK(holds(stopped.error, "the same command continues"));
  succeeds(arguments + "parts'");
  for (const char* name : {"/weights.npz", "/checkpoint.npz", "/curve.json"}) {
    CAPTURE(name);
    CHECK(file_contents(folder.file("parts") + name) == file_contents(folder.file("whole") + name));
  }
}

TEST_CASE("what processes cannot share is refused in one line") {
  if (mpirun().empty()) return;
  const TemporaryDirectory folder;
  write_file(folder.file("recipe.json"), recipe(3));
  const std::string arguments =
      fmt::format("train --config '{0}/recipe.json' --out '{0}/out'", folder.path().string());
  const ProgramResult three = run_on_ranks(2, arguments);
  CHECK(three.status == 2);
  CHECK(count(three.error, "recipe.json: training: batch is 3, which 2 processes cannot") == 1);
  CHECK_FALSE(fs::exists(folder.file("out")));
  write_file(folder.file("recipe.json"), "{");
  const ProgramResult broken = run_on_ranks(2, arguments);
  CHECK(broken.status == 2);
  CHECK(count(broken.error, "hqslam-lab: ") == 1);  // rank 0 alone has looked at it
}

TEST_CASE("two processes make the table that one makes, and one shows what they left") {
  if (mpirun().empty()) return;
  const TemporaryDirectory folder;
  for (const std::string& how :
       {std::string("--drives block"), std::string("--drives block --seeds 5,6,7")}) {
    CAPTURE(how);
    const std::string arguments =
        fmt::format("table {} --scans 4 --methods rows-16,linear,rows-64", how);
    const std::string one = folder.file("one" + std::to_string(how.size()));
    const std::string two = folder.file("two" + std::to_string(how.size()));
    succeeds(arguments + " --out '" + one + "'");
    const ProgramResult by_two = run_on_ranks(2, arguments + " --out '" + two + "'");
    CAPTURE(by_two.error);
    REQUIRE(by_two.status == 0);
    CHECK(count(by_two.out, "results: ") == 1);
    int results = 0;
    for (const auto& entry : fs::recursive_directory_iterator(one + "/results")) {
      if (!entry.is_regular_file()) continue;
      ++results;
      const std::string name = fs::relative(entry.path(), one).string();
      CAPTURE(name);
      REQUIRE(fs::exists(two + "/" + name));
      if (entry.path().extension() == ".json") {
        const nlohmann::json a = json_of(entry.path().string());
        const nlohmann::json b = json_of(two + "/" + name);
        CHECK(a["settings"] == b["settings"]);
        CHECK(a["result"] == b["result"]);
      } else {
        CHECK(file_contents(two + "/" + name) == file_contents(entry.path().string()));
      }
    }
    CHECK(results >= 6);
    // Made again by one from what the two have left, with its times: the same page.
    const std::string page = file_contents(two + "/table.html");
    const std::string json = file_contents(two + "/table.json");
    CHECK(run_hqslam(arguments + " --out '" + two + "'").error.empty());
    CHECK(file_contents(two + "/table.html") == page);
    CHECK(file_contents(two + "/table.json") == json);
  }
}

}  // namespace hqslam::test

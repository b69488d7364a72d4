#include <doctest/doctest.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/file.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <thread>
#include <vector>

#include "hqslam/core/trajectory.h"
#include "hqslam/nn/weights_file.h"
#include "tools/program/arguments.h"
#include "tools/program/child.h"
#include "tools/program/program.h"

// What goes wrong around the program: streams that are closed or full, disks that are full, signals
// at any moment, two programs in one folder.

namespace hqslam::test {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> parts_below(const fs::path& folder) {
  std::vector<std::string> parts;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.path().string().find(".part") != std::string::npos) parts.push_back(entry.path());
  }
  return parts;
}

}  // namespace

TEST_CASE("a closed or full stderr costs nothing, and nothing is written into the results") {
  const TemporaryDirectory folder;
  REQUIRE(run_hqslam(simulate_arguments(folder.file("usual"))).status == 0);
  for (const char* stream : {"2>&-", "2>/dev/full", "0<&- 1>/dev/null 2>&-"}) {
    CAPTURE(stream);
    const TemporaryDirectory out;
    CHECK(run_hqslam(simulate_arguments(out.file("drive")) + " " + stream).status == 0);
    CHECK(file_contents(out.file("drive/scans.npy")) ==
          file_contents(folder.file("usual/scans.npy")));
    CHECK(run_hqslam(run_arguments(out.file("run")) + " " + stream).status == 0);
    CHECK(read_tum(out.file("run/trajectory.tum")).size() == kDriveScans);
  }
  CHECK(run_hqslam(train_arguments(folder, folder.file("trained")) + " 2>/dev/full").status == 0);
  CHECK_NOTHROW(nn::read_weights(folder.file("trained/weights.npz")));
}

TEST_CASE("what cannot be printed is told by the exit status, the results are written") {
  const TemporaryDirectory folder;
  const ProgramResult full = run_hqslam(evaluate_arguments() + " >/dev/full");
  CHECK(full.status == 1);
  CHECK(is_one_line(full.error));
  CHECK(holds(full.error, "No space left"));
  CHECK(run_hqslam(evaluate_arguments() + " >&-").status == 1);
  CHECK(run_hqslam("--help >/dev/full").status == 1);
  CHECK(run_hqslam(run_arguments(folder.file("out")) + " >/dev/full").status == 1);
  CHECK(fs::exists(folder.file("out/report.html")));
  CHECK(run_hqslam(train_arguments(folder, folder.file("trained")) + " >&-").status == 1);
  CHECK_NOTHROW(nn::read_weights(folder.file("trained/weights.npz")));
}

TEST_CASE("a reader that goes away stops no training and is not complained about") {
  const TemporaryDirectory folder;
  const ProgramResult result =
      run_shell(fmt::format("{{ sleep 0.2; {} {}; echo $? >'{}'; }} | true", kProgram,
                            train_arguments(folder, folder.file("out")), folder.file("status")));
  CHECK(file_contents(folder.file("status")) == "1\n");
  CHECK(!holds(result.error, "printed"));
  CHECK_NOTHROW(nn::read_weights(folder.file("out/weights.npz")));
}

TEST_CASE("a terminal that is closed, and a polite kill, leave a checkpoint to go on from") {
  for (const int signal_number : {SIGHUP, SIGTERM}) {
    const TemporaryDirectory folder;
    const std::string out = folder.file("out");
    Child child(train_arguments(folder, out, 100000));
    child.wait_for(out + "/checkpoint.npz");
    CHECK(child.end(signal_number) == 130);
    CHECK_NOTHROW(nn::read_weights(out + "/weights.npz"));
    CHECK(parts_below(folder.path()).empty());
  }
}

TEST_CASE("a program that was told to ignore hang-ups ignores them") {
  const TemporaryDirectory folder;
  const std::string out = folder.file("out");
  const ProgramResult result =
      run_shell(fmt::format("trap '' HUP; {} {} & pid=$!; sleep 0.3; kill -HUP $pid; wait $pid",
                            kProgram, train_arguments(folder, out, 30)));
  CHECK(result.status == 0);
}

TEST_CASE("killed at any moment, a program leaves what its next run can do with") {
  struct Work {
    const char* name;
    std::function<std::string(const TemporaryDirectory&, const std::string&)> arguments;
    const char* result;
  };
  const std::vector<Work> works = {
      {"simulate",
       [](const TemporaryDirectory&, const std::string& out) {
         return simulate_arguments(out, 12);
       },
       "scans.npy"},
      {"upsample",
       [](const TemporaryDirectory&, const std::string& out) { return upsample_arguments(out); },
       "scans.npy"},
      {"run", [](const TemporaryDirectory&, const std::string& out) { return run_arguments(out); },
       "report.html"},
      {"train",
       [](const TemporaryDirectory& folder, const std::string& out) {
         return train_arguments(folder, out);
       },
       "weights.npz"},
      {"table",
       [](const TemporaryDirectory&, const std::string& out) { return table_arguments(out); },
       "table.json"},
  };
  simulated_drive();
  for (const Work& work : works) {
    const TemporaryDirectory folder;
    const std::string out = folder.file("out");
    const std::string arguments = work.arguments(folder, out);
    for (const int after_ms : {5, 60, 150, 300}) {
      Child child(arguments);
      std::this_thread::sleep_for(std::chrono::milliseconds(after_ms));
      child.end(SIGKILL);
    }
    const ProgramResult result = run_hqslam(arguments);
    CAPTURE(work.name);
    CAPTURE(result.error);
    CHECK(result.status == 0);
    CHECK(fs::exists(out + "/" + work.result));
    CHECK(parts_below(folder.path()).empty());
    const TemporaryDirectory undisturbed;
    const std::string usual = undisturbed.file("out");
    REQUIRE(run_hqslam(work.arguments(undisturbed, usual)).status == 0);
    for (const char* same : {"scans.npy", "weights.npz", "trajectory.tum", "map.pcd"}) {
      if (!fs::exists(usual + "/" + same)) continue;
      CHECK(file_contents(out + "/" + same) == file_contents(usual + "/" + same));
    }
  }
}

TEST_CASE("after a full disk the same command does what it could not do") {
  // A limit on the size of a file fails as a full disk does: in the middle, or at once.
  for (const int blocks : {0, 1, 200}) {
    const TemporaryDirectory folder;
    for (const std::string& arguments :
         {simulate_arguments(folder.file("drive")), upsample_arguments(folder.file("lifted")),
          run_arguments(folder.file("run")), train_arguments(folder, folder.file("trained"))}) {
      CAPTURE(arguments);
      const ProgramResult full = run_shell(fmt::format(
          "(trap '' 25; ulimit -f {}; exec {} {} 2>&1) | cat >&2", blocks, kProgram, arguments));
      CAPTURE(full.error);
      CHECK(holds(full.error, folder.path().string()));
      CHECK(parts_below(folder.path()).empty());
      const ProgramResult again = run_hqslam(arguments);
      CAPTURE(again.error);
      CHECK(again.status == 0);
    }
  }
}

TEST_CASE("two programs do not write into one folder") {
  const TemporaryDirectory folder;
  const std::string out = folder.file("out");
  fs::create_directory(out);
  const int descriptor = open(out.c_str(), O_RDONLY);
  REQUIRE(flock(descriptor, LOCK_EX | LOCK_NB) == 0);
  for (const std::string& arguments :
       {simulate_arguments(out), upsample_arguments(out), run_arguments(out), table_arguments(out),
        train_arguments(folder, out)}) {
    CAPTURE(arguments);
    const ProgramResult result = run_hqslam(arguments + " 2>&1 >/dev/null | tail -1 >&2");
    CHECK(is_one_line(result.error));
    CHECK(holds(result.error, "another hqslam is writing into it"));
    CHECK(run_hqslam(arguments).status == 2);
    CHECK(fs::is_empty(out));
  }
  close(descriptor);
  CHECK(run_hqslam(simulate_arguments(out)).status == 0);
}

TEST_CASE("a simulation that was stopped is used, and said to be one") {
  const TemporaryDirectory folder;
  const std::string drive = folder.file("drive");
  {
    Child child(simulate_arguments(drive, 5000));
    child.wait_for(drive + "/truth.tum");
    while (!(fs::exists(drive + "/truth.tum") && fs::file_size(drive + "/truth.tum") > 500)) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    child.end(SIGKILL);
  }
  const ProgramResult result =
      run_hqslam(fmt::format("run '{}' --out '{}'", drive, folder.file("out")));
  CHECK(result.status == 0);
  CHECK(holds(result.error, "the simulation was stopped after"));
  CHECK_FALSE(holds(run_hqslam(run_arguments(folder.file("whole"))).error, "stopped"));
}

}  // namespace hqslam::test

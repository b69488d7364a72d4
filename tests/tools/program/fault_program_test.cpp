#include <doctest/doctest.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <thread>
#include <vector>

#include "hqslam/core/trajectory.h"
#include "hqslam/nn/weights_file.h"
#include "tools/program/arguments.h"
#include "tools/program/child.h"
#include "tools/program/program.h"
#include "tools/program/writers.h"

// What goes wrong around the program: streams that are closed or full, disks that are full, signals
// at any moment, two programs in one folder.

namespace hqslam::test {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> parts_below(const fs::path& folder) {
  std::vector<std::string> parts;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    if (holds(entry.path().string(), ".part")) parts.push_back(entry.path());
  }
  return parts;
}

/// Said in one line, after those that are usual.
bool is_refusal(const ProgramResult& result) {
  return result.status == 2 && is_one_line(result.error) &&
         holds(result.error, "is there already and");
}

}  // namespace

TEST_CASE("a closed or full stderr costs nothing, and nothing is written into the results") {
  const TemporaryDirectory folder;
  succeeds(simulate_arguments(folder.file("usual")));
  for (const char* stream : {"2>&-", "2>/dev/full", "0<&- 1>/dev/null 2>&-"}) {
    CAPTURE(stream);
    const TemporaryDirectory out;
    succeeds(simulate_arguments(out.file("drive")) + " " + stream);
    CHECK(file_contents(out.file("drive/scans.npy")) ==
          file_contents(folder.file("usual/scans.npy")));
    succeeds(run_arguments(out.file("run")) + " " + stream);
    CHECK(read_tum(out.file("run/trajectory.tum")).size() == kShortDriveScans);
  }
  succeeds(train_arguments(folder, folder.file("trained")) + " 2>/dev/full");
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
  CHECK_FALSE(holds(result.error, "printed"));
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
  for (const Writer& writer : writers()) {
    if (!writer.is_quick) continue;
    const TemporaryDirectory folder;
    const std::string out = folder.file("out");
    const std::string arguments = writer.arguments(folder, out);
    for (const int after_ms : {5, 40, 80, 150, 300}) {
      Child child(arguments);
      const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(after_ms);
      child.wait_until([&] { return std::chrono::steady_clock::now() >= end; });
      child.end(SIGKILL);
    }
    const ProgramResult result = run_hqslam(arguments);
    CAPTURE(writer.name);
    CAPTURE(result.error);
    CHECK(result.status == 0);
    CHECK(fs::exists(writer.result(out)));
    CHECK(parts_below(folder.path()).empty());
    const TemporaryDirectory undisturbed;
    const std::string usual = undisturbed.file("out");
    succeeds(writer.arguments(undisturbed, usual));
    for (const char* same : {"scans.npy", "weights.npz", "trajectory.tum", "map.pcd",
                             "dense_map.pcd", "bin/000002.bin"}) {
      if (!fs::exists(usual + "/" + same)) continue;
      CHECK(file_contents(out + "/" + same) == file_contents(usual + "/" + same));
    }
  }
}

TEST_CASE("after a full disk the same command does what it could not do") {
  // A limit on the size of a file fails as a full disk does: in the middle, or at once.
  for (const int blocks : {0, 1, 200}) {
    for (const Writer& writer : writers()) {
      if (!writer.is_quick) continue;
      const TemporaryDirectory folder;
      const std::string arguments = writer.arguments(folder, folder.file("out"));
      CAPTURE(writer.name);
      const ProgramResult full = run_shell(fmt::format(
          "(trap '' 25; ulimit -f {}; exec {} {} 2>&1) | cat >&2", blocks, kProgram, arguments));
      CAPTURE(full.error);
      if (blocks == 0) CHECK(holds(full.error, folder.path().string()));
      CHECK(parts_below(folder.path()).empty());
      succeeds(arguments);
    }
  }
}

TEST_CASE("no command replaces what it did not write") {
  for (const Writer& writer : writers()) {
    const std::vector<std::string> paths = [&] {
      std::vector<std::string> in_out;
      for (const std::string& result : writer.results) in_out.push_back("out/" + result);
      return in_out.empty() ? std::vector<std::string>{"out"} : in_out;
    }();
    for (const std::string& path : paths) {
      CAPTURE(writer.name);
      CAPTURE(path);
      const TemporaryDirectory folder;
      if (writer.writes_folder()) fs::create_directory(folder.file("out"));
      write_file(folder.file(path), "somebody's own");
      const ProgramResult result = run_hqslam(writer.arguments(folder, folder.file("out")));
      CHECK(is_refusal(result));
      CHECK(holds(result.error, folder.file(path)));
      CHECK(file_contents(folder.file(path)) == "somebody's own");
    }
  }
}

TEST_CASE(
    "nothing that is no regular file is written over, not even among a command's own results") {
  for (const Writer& writer : writers()) {
    CAPTURE(writer.name);
    const TemporaryDirectory folder;
    const std::string out = folder.file("out");
    const std::string arguments = writer.arguments(folder, out);
    // A command replaces its own results.
    for (int run = 0; run < 2 && writer.is_quick; ++run) succeeds(arguments);
    if (writer.writes_folder()) fs::create_directories(out);
    const std::string in_the_way = writer.result(out);
    fs::remove(in_the_way);
    REQUIRE(mkfifo(in_the_way.c_str(), 0600) == 0);
    CHECK(is_refusal(run_hqslam(arguments)));
    CHECK(fs::is_fifo(in_the_way));
    fs::remove(in_the_way);
    fs::create_directory(in_the_way);
    CHECK(is_refusal(run_hqslam(arguments)));
    CHECK(fs::is_directory(in_the_way));
  }
}

TEST_CASE("no command replaces what it reads") {
  const WriterInputs& in = writer_inputs();
  const TemporaryDirectory folder;
  const std::string out = folder.file("out");
  succeeds(run_arguments(out));
  const std::string options = folder.file("lifted");
  succeeds(upsample_arguments(options));
  const std::string arrays = folder.file("arrays.npz");
  fs::copy_file(in.weights, arrays);  // weights are arrays too
  struct Reading {
    std::string arguments;
    std::string read;
  };
  for (const auto& [arguments, read] : std::vector<Reading>{
           {fmt::format("weights pack '{0}' '{1}' --out '{0}'", arrays, in.network), arrays},
           {run_arguments(out) + fmt::format(" --reference '{}/trajectory.tum'", out),
            out + "/trajectory.tum"},
           {fmt::format("upsample '{0}/scans.npy' --method linear --sensor os1-64 --rows 16 "
                        "--out '{0}'",
                        options),
            options + "/scans.npy"},
           {fmt::format("simulate --drive block --scans 2 --sensor '{0}/sensor.json' --out '{0}'",
                        in.drive_of_64),
            in.drive_of_64 + "/sensor.json"}}) {
    CAPTURE(arguments);
    const std::string before = file_contents(read);
    CHECK(run_hqslam(arguments).status == 2);
    CHECK(file_contents(read) == before);
  }
}

TEST_CASE("a broken input is one line, and nothing is written") {
  const WriterInputs& in = writer_inputs();
  const TemporaryDirectory broken;
  const std::string text = "what is this?";
  for (const char* name : {"x.npy", "x.npz", "x.json", "x.pcap", "x.mcap", "x.tum", "x.pcd"}) {
    write_file(broken.file(name), text);
  }
  const auto file = [&](const char* name) { return "'" + broken.file(name) + "'"; };
  const std::string out = " --out '" + broken.file("out") + "'";
  for (const std::string& arguments :
       {"run " + file("x.npy") + " --sensor os1-16" + out,
        "run " + file("x.pcap") + out,
        "run '" + in.drive + "' --map " + file("x.npz") + out,
        "run '" + in.drive + "' --reference " + file("x.tum") + out,
        "run '" + in.drive + "' --slam-options " + file("x.json") + out,
        "upsample " + file("x.mcap") + " --method linear" + out,
        "upsample '" + in.drive + "' --weights " + file("x.npz") + out,
        "map '" + in.drive + "' --poses " + file("x.tum") + out,
        "inspect '" + in.drive_of_64 + "' --weights " + file("x.npz") + out,
        "compare " + file("x.npy") + " --sensor os1-64",
        "compare '" + in.drive_of_64 + "' --weights " + file("x.npz"),
        "table --drives " + file("x.npy") + " --sensor os1-64" + out,
        "table --drives block --weights " + file("x.npz") + " --methods rows-16 --scans 2" + out,
        "train --config " + file("x.json") + out,
        "simulate --drive block --scans 2 --sensor " + file("x.json") + out,
        "live --sensor " + file("x.json") + out,
        "bench --input " + file("x.npy") + " --sensor os1-64",
        "info " + file("x.pcap"),
        "evaluate " + file("x.tum") + " " + file("x.tum"),
        "evaluate " + file("x.pcd") + " " + file("x.pcd"),
        "evaluate-map " + file("x.pcd") + " --drive '" + in.drive + "'",
        "weights show " + file("x.npz"),
        "weights pack " + file("x.npz") + " " + file("x.json") + out}) {
    CAPTURE(arguments);
    const ProgramResult result = run_hqslam(arguments);
    CAPTURE(result.error);
    CHECK(is_one_line(last_line(result.error)));
    CHECK(result.status == 2);
    for (const char* name : {"x.npy", "x.npz", "x.json"})
      CHECK(file_contents(broken.file(name)) == text);
  }
}

TEST_CASE("two programs do not write into one folder") {
  const TemporaryDirectory folder;
  const std::string out = folder.file("out");
  fs::create_directory(out);
  const int descriptor = open(out.c_str(), O_RDONLY);
  REQUIRE(flock(descriptor, LOCK_EX | LOCK_NB) == 0);
  for (const Writer& writer : writers()) {
    if (!writer.writes_folder() || !writer.locks) continue;
    CAPTURE(writer.name);
    const std::string arguments = writer.arguments(folder, out);
    const ProgramResult result = run_hqslam(arguments);
    CHECK(is_one_line(last_line(result.error)));
    CHECK(holds(last_line(result.error), "another hqslam is writing into it"));
    CHECK(result.status == 2);
    CHECK(fs::is_empty(out));
  }
  close(descriptor);
  succeeds(simulate_arguments(out));
}

TEST_CASE("a run says that it is running until it has ended") {
  const TemporaryDirectory folder;
  const std::string out = folder.file("out");
  {
    Child child(
        fmt::format("run '{}' --upsample linear --rows 4 --out '{}'", simulated_drive(), out));
    child.wait_for(out + "/trajectory.tum");
    child.end(SIGKILL);
  }
  const std::string killed = file_contents(out + "/timings.json");
  const bool ended_first = fs::exists(out + "/report.html");
  CHECK((ended_first || holds(killed, "\"end\": \"running\"")));
  succeeds(run_arguments(out));
  CHECK(holds(file_contents(out + "/timings.json"), "\"end\": \"complete\""));
}

TEST_CASE("a lifting that was stopped is used, and said to be one") {
  const TemporaryDirectory folder;
  const std::string out = folder.file("out");
  {
    Child child(fmt::format("upsample '{}' --weights '{}' --bin --pcd --out '{}'",
                            simulated_drive("--sensor os1-64 --seed 5 --scans 24"),
                            writer_inputs().weights, out));
    child.wait_until([&] { return fs::exists(out + "/bin/000000.bin"); });
    child.end(SIGKILL);
  }
  const bool ended_first = holds(file_contents(out + "/upsample.json"), "\"complete\": true");
  const std::string arguments = " --sensor os1-64 --out '" + folder.file("run") + "'";
  const ProgramResult result = succeeds("run '" + out + "'" + arguments);
  CHECK((ended_first || holds(result.error, "hqslam upsample was stopped after")));
  for (const char* scans : {"/bin", "/pcd"}) {
    succeeds("run '" + out + scans + "'" + arguments);
  }
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
  const ProgramResult result = succeeds("run '{}' --out '{}'", drive, folder.file("out"));
  CHECK(holds(result.error, "the simulation was stopped after"));
  CHECK_FALSE(holds(run_hqslam(run_arguments(folder.file("whole"))).error, "stopped"));
}

}  // namespace hqslam::test

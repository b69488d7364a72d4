#include <doctest/doctest.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/file.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <thread>
#include <vector>

#include "hqslam/core/npy.h"
#include "hqslam/core/trajectory.h"
#include "hqslam/nn/hqs/weights_file.h"
#include "tools/program/program.h"

// What goes wrong around the program: streams that are closed or full, disks that are full, signals
// at any moment, two programs in one folder, names and locales of all kinds.

namespace hqslam::test {
namespace {

namespace fs = std::filesystem;

bool holds(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

bool is_one_line(const std::string& text) {
  return !text.empty() && text.find('\n') == text.size() - 1;
}

const std::string kProgram = std::string("'") + HQSLAM_PROGRAM + "'";

std::string evaluate_arguments() {
  return fmt::format("evaluate '{0}/truth.tum' '{0}/truth.tum'", simulated_drive());
}

std::string simulate_arguments(const std::string& out, int scans = 3) {
  return fmt::format("simulate --drive block --sensor os1-16 --scans {} --out '{}'", scans, out);
}

std::string upsample_arguments(const std::string& out) {
  return fmt::format("upsample '{}' --method linear --sensor os1-64 --bin --out '{}'",
                     simulated_drive() + "/pcd", out);
}

std::string run_arguments(const std::string& out) {
  return fmt::format("run '{}' --out '{}'", simulated_drive(), out);
}

/// Trains for so many steps; the recipe and the drives lie in `folder`.
std::string train_arguments(const TemporaryDirectory& folder, const std::string& out,
                            int steps = 3) {
  write_file(folder.file("recipe.json"), fmt::format(R"({{
    "network": {{"kind": "du-or", "layers": 1, "sensor": "os1-64", "measured_rows": 16,
                 "denoiser": {{"channels": [4, 4], "memory": 1}}}},
    "training": [{{"drive": "block", "seeds": [5], "scans": 2}}],
    "validation": [{{"drive": "block", "seeds": [6], "scans": 1}}],
    "steps": {}, "batch": 1, "augmentation": {{"crop_columns": 64}}, "validate_every": 2
  }})",
                                                     steps));
  return fmt::format("train --config '{0}/recipe.json' --out '{1}' --drives '{0}/drives'",
                     folder.path().string(), out);
}

std::string table_arguments(const std::string& out) {
  return fmt::format("table --drives block --methods rows-16 --scans 3 --out '{}'", out);
}

/// The program in the background.
class Child {
 public:
  explicit Child(const std::string& arguments) : pid_(fork()) {
    if (pid_ == 0) {
      const std::string command = "exec " + kProgram + " " + arguments + " >/dev/null 2>&1";
      execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
      _exit(127);
    }
  }
  ~Child() {
    if (pid_ > 0) end(SIGKILL);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  /// Until something is at `path` or the program has ended.
  void wait_for(const std::string& path) const {
    while (!fs::exists(path) && kill(pid_, 0) == 0 && waitpid(pid_, nullptr, WNOHANG) == 0) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  }

  /// Sends a signal and waits; returns the exit status, -1 if it was killed.
  int end(int signal_number) {
    int status = 0;
    kill(pid_, signal_number);
    waitpid(pid_, &status, 0);
    pid_ = 0;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

 private:
  pid_t pid_;
};

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

TEST_CASE("results are not written among the scans that they are made from") {
  const TemporaryDirectory folder;
  fs::copy(simulated_drive() + "/pcd", folder.file("pcd"));
  fs::create_directory_symlink(folder.file("pcd"), folder.file("link"));
  for (const char* out : {"pcd", "link", "pcd/../pcd"}) {
    const ProgramResult result = run_hqslam(
        fmt::format("run '{0}/pcd' --sensor os1-16 --out '{0}/{1}'", folder.path().string(), out));
    CHECK(result.status == 2);
    CHECK(is_one_line(result.error));
    CHECK(holds(result.error, "holds the recording"));
  }
  CHECK_FALSE(fs::exists(folder.file("pcd/map.pcd")));
}

TEST_CASE("names and contents of files do not steer the terminal, and stay in one line") {
  const TemporaryDirectory folder;
  const std::string pcd =
      "# .PCD v0.7\nVERSION 0.7\nFIELDS \x1b[31mred " + std::string(100000, 'a') +
      " z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1\nHEIGHT 1\nPOINTS 1\nDATA ascii\n1 2 3\n";
  const std::string name = folder.file("a\n\x1b[2Jb.pcd");
  write_file(name, pcd);
  const ProgramResult result =
      run_hqslam(fmt::format("run '{}' --sensor os1-16 --out '{}' 2>&1 >/dev/null | tail -1 >&2",
                             name, folder.file("out")));
  CHECK(is_one_line(result.error));
  CHECK(result.error.size() < 6000);
  CHECK(result.error.find('\x1b') == std::string::npos);
  CHECK(holds(result.error, "\\x1b[31mred"));
  CHECK(holds(result.error, "a\\n\\x1b[2Jb.pcd"));
}

TEST_CASE("a path that cannot be is wrong input") {
  const std::string long_name(300, 'a');
  const TemporaryDirectory folder;
  for (const std::string& out : {long_name, std::string("/dev/null/x"), std::string("/proc/x/y")}) {
    for (const std::string& arguments :
         {simulate_arguments(out), upsample_arguments(out), run_arguments(out),
          table_arguments(out), train_arguments(folder, out), "demo --out '" + out + "'"}) {
      CAPTURE(arguments);
      const ProgramResult result = run_hqslam(arguments + " 2>&1 >/dev/null | tail -1 >&2");
      CHECK(is_one_line(result.error));
      CHECK(holds(result.error, out));
      CHECK(run_hqslam(arguments).status == 2);
    }
  }
}

TEST_CASE("a recipe that is no file, or no text, is refused without being read") {
  const TemporaryDirectory folder;
  write_file(folder.file("large.json"), "{");
  fs::resize_file(folder.file("large.json"), std::uintmax_t{3} << 30U);
  for (const std::string& recipe :
       {std::string("/dev/zero"), folder.file("large.json"), folder.path().string()}) {
    const ProgramResult result =
        run_shell(fmt::format("ulimit -v 1000000; exec {} train --config '{}' --out '{}'", kProgram,
                              recipe, folder.file("out")));
    CHECK(result.status == 2);
    CHECK(holds(result.error, recipe + ": expected a training configuration (.json)"));
  }
}

TEST_CASE("stacks without a single range that the sensor can measure are not trained on") {
  constexpr float kInfinite = std::numeric_limits<float>::infinity();
  for (const float range_m : {0.0F, 1e30F, kInfinite, -1.0F}) {
    const TemporaryDirectory folder;
    {
      NpyStackWriter writer(folder.file("stack.npy"), 64, 1024);
      RangeImage image(64, 1024);
      image.range_m.assign(image.range_m.size(), range_m);
      for (int i = 0; i < 2; ++i) writer.append(image);
    }
    const std::string arguments = train_arguments(folder, folder.file("out"));
    std::string recipe = file_contents(folder.file("recipe.json"));
    const std::string drive = R"({"drive": "block", "seeds": [5], "scans": 2})";
    recipe.replace(recipe.find(drive), drive.size(),
                   fmt::format(R"({{"stack": "{}"}})", folder.file("stack.npy")));
    write_file(folder.file("recipe.json"), recipe);
    const ProgramResult result = run_hqslam(arguments);
    CHECK(result.status == 2);
    CHECK(holds(result.error, "stack.npy: expected images with ranges"));
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
  const ProgramResult result =
      run_hqslam(fmt::format("run '{}' --out '{}'", drive, folder.file("out")));
  CHECK(result.status == 0);
  CHECK(holds(result.error, "the simulation was stopped after"));
  CHECK_FALSE(holds(run_hqslam(run_arguments(folder.file("whole"))).error, "stopped"));
}

TEST_CASE("more threads than any machine has are not started") {
  const TemporaryDirectory folder;
  const ProgramResult result = run_shell(
      fmt::format("OMP_NUM_THREADS=100000 {} {}", kProgram, run_arguments(folder.file("out"))));
  CHECK(result.status == 0);
  const ProgramResult usual = run_hqslam(run_arguments(folder.file("usual")));
  CHECK(file_contents(folder.file("out/trajectory.tum")) ==
        file_contents(folder.file("usual/trajectory.tum")));
}

TEST_CASE("paths with blanks, quotes and letters of all kinds do, and a comma locale") {
  const TemporaryDirectory folder;
  const fs::path place = folder.path() / "Meine Fahrten über Größe \"eins\" 東京";
  fs::create_directory(place);
  fs::copy(simulated_drive(), place / "die Fahrt", fs::copy_options::recursive);
  const std::string locales = folder.file("locales");
  fs::create_directory(locales);
  const bool comma =
      run_shell("localedef -i de_DE -f UTF-8 '" + locales + "/de_DE.UTF-8'").status == 0;
  if (!comma) MESSAGE("SKIPPED: a comma locale (there is no localedef)");
  const std::string environment =
      comma ? fmt::format("LOCPATH='{}' LC_ALL=de_DE.UTF-8 LANG=de_DE.UTF-8 ", locales) : "";
  const auto in_place = [&](const std::string& arguments) {
    return run_shell("cd '" + place.string() + "'; " + environment + kProgram + " " + arguments);
  };
  REQUIRE(in_place("run 'die Fahrt' --out 'das Ergebnis: ä'").status == 0);
  REQUIRE(run_hqslam(run_arguments(folder.file("usual"))).status == 0);
  for (const char* name : {"trajectory.tum", "trajectory.kitti", "map.pcd"}) {
    CHECK(file_contents((place / "das Ergebnis: ä" / name).string()) ==
          file_contents(folder.file(std::string("usual/") + name)));
  }
  CHECK(in_place("upsample 'die Fahrt/pcd' --method linear --sensor os1-64 --out 'höher'").status ==
        0);
  CHECK(in_place("run höher --out 'noch ein Ergebnis'").status == 0);
  CHECK(in_place("run 'kein Ördner' --sensor os1-16 --out x").error.find("kein Ördner") !=
        std::string::npos);
}

}  // namespace hqslam::test

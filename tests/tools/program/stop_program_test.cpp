#include "tools/program/child.h"
#include "tools/program/commands.h"

// Streams that are closed or full, readers that go away, signals, and what was stopped half-way.

namespace hqslam::test {
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

TEST_CASE("a reader that goes away stops no training and is not complained about") {
  const TemporaryDirectory folder;
  const ProgramResult result = run_shell(fmt::format(
      "{{ until [ -e '{0}/gone' ]; do sleep 0.01; done; {1}; echo $? >'{0}/status'; }} | "
      "{{ exec <&-; touch '{0}/gone'; }}",
      folder.path(), command_line(train_arguments(folder, folder.file("out")))));
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

TEST_CASE("a program started with hang-ups ignored ignores them") {
  const TemporaryDirectory folder;
  const std::string out = folder.file("out");
  ::signal(SIGHUP, SIG_IGN);  // which a child inherits
  Child child(train_arguments(folder, out, 30));
  ::signal(SIGHUP, SIG_DFL);
  child.wait_for(out + "/checkpoint.npz");
  CHECK(child.end(SIGHUP) == 0);
}

TEST_CASE("a run says that it is running until it has ended") {
  const TemporaryDirectory folder;
  const std::string out = folder.file("out");
  Child(fmt::format("run '{}' --upsample linear --rows 4 --out '{}'", simulated_drive(), out))
      .wait_for(out + "/trajectory.tum");  // and killed
  const std::string killed = file_contents(out + "/timings.json");
  const bool ended_first = fs::exists(out + "/report.html");
  CHECK((ended_first || holds(killed, "\"end\": \"running\"")));
  succeeds(run_arguments(out));
  CHECK(holds(file_contents(out + "/timings.json"), "\"end\": \"complete\""));
}

TEST_CASE("an upsampling that was stopped is used, and named as incomplete") {
  const TemporaryDirectory folder;
  const std::string out = folder.file("out");
  Child(fmt::format("upsample '{}' --weights '{}' --bin --pcd --out '{}'", drive_of_64(),
                    command_inputs().paths.at("weights"), out))
      .wait_for(out + "/bin/000000.bin");  // and killed
  const bool ended_first = holds(file_contents(out + "/upsample.json"), "\"complete\": true");
  const std::string arguments = " --sensor os1-64 --out '" + folder.file("run") + "'";
  const ProgramResult result = succeeds("run '" + out + "'" + arguments);
  CHECK((ended_first || holds(result.error, "hqslam upsample was stopped after")));
  for (const char* scans : {"/bin", "/pcd"}) succeeds("run '" + out + scans + "'" + arguments);
}

TEST_CASE("a simulation that was stopped is used, and named as incomplete") {
  const TemporaryDirectory folder;
  const std::string drive = folder.file("drive");
  Child(simulate_arguments(drive, 5000)).wait_until([&] {
    return fs::exists(drive + "/truth.tum") && fs::file_size(drive + "/truth.tum") > 500;
  });  // and killed
  const ProgramResult result = succeeds("run '{}' --out '{}'", drive, folder.file("out"));
  CHECK(holds(result.error, "the simulation was stopped after"));
  CHECK_FALSE(holds(run_hqslam(run_arguments(folder.file("whole"))).error, "stopped"));
}

}  // namespace hqslam::test

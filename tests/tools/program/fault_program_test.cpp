#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "hqslam/core/cloud_file.h"
#include "tools/program/commands.h"

// What goes wrong around every command: disks that are full, programs that are killed, what is in
// the way of results, inputs that are broken, two programs in one folder.

namespace hqslam::test {
namespace {

/// Of what gets its name once all of it is there: whether it is. Other files grow scan by scan.
bool is_whole(const std::string& path) {
  const std::string extension = fs::path(path).extension();
  if (extension == ".npz") return error_message([&] { read_npz(path); }) == "no Error";
  if (extension == ".pcd") return error_message([&] { read_cloud(path); }) == "no Error";
  static const std::map<std::string, std::string> ends = {{".html", "</html>\n"}, {".json", "}\n"}};
  const auto end = ends.find(extension);
  return end == ends.end() || file_contents(path).ends_with(end->second);
}

/// The files of a command's results that are there, by where they are behind {out}.
std::map<std::string, std::string> files_of(const Command& command, const std::string& out) {
  std::map<std::string, std::string> files;
  const auto add = [&](const std::string& path) {
    if (fs::is_regular_file(path)) files[path.substr(out.size())] = file_contents(path);
  };
  for (const std::string& result : command.results) {
    add(out + result);
    if (!fs::is_directory(out + result)) continue;
    for (const auto& scan : fs::directory_iterator(out + result)) add(scan.path());
  }
  return files;
}

/// Results whose bytes no other run has.
bool tells_times(const std::string& result) {
  return result == "/timings.json" || result == "/report.html" || result.starts_with("/table.") ||
         result == "" || result == "/curve.json";
}

/// No file grows beyond this many blocks of 512 bytes: the command fails as with a full disk, or is
/// killed in the middle of writing.
struct Stop {
  int blocks;
  bool is_kill;
};

/// Runs a command; whether it was stopped, and did not write less than that.
bool run_stopped(const Stop& stop, const std::string& arguments, const TemporaryDirectory& folder) {
  CAPTURE(stop.blocks);
  CAPTURE(stop.is_kill);
  constexpr int kKilled = 128 + SIGXFSZ;
  // What is printed goes through a pipe, which no limit is on; the shell of the parentheses tells
  // how a program was killed.
  const ProgramResult result = run_shell(fmt::format(
      fmt::runtime(stop.is_kill
                       ? "(ulimit -c 0; ulimit -f {}; '{}' {} >/dev/null 2>&1; exit $?)"
                       : "(trap '' XFSZ; ulimit -f {}; '{}' {} 2>&1; echo status $?) | cat >&2"),
      stop.blocks, program_of(arguments), arguments));
  CAPTURE(result.error);
  const bool was_stopped = stop.is_kill ? result.status != 0 : !holds(result.error, "status 0\n");
  CHECK((was_stopped || stop.blocks > 0));
  if (stop.is_kill) {
    CHECK((!was_stopped || result.status == kKilled));
    // A drive that train was simulating: no other program takes this one's unfinished file.
    for (const std::string& part : parts_below(folder.path())) {
      if (holds(part, "/drives/")) fs::remove(part);
    }
    return was_stopped;
  }
  CHECK((!was_stopped || holds(result.error, "status 2\n")));
  if (was_stopped) CHECK(holds(result.error, folder.path()));
  CHECK(parts_below(folder.path()).empty());
  return was_stopped;
}

std::vector<std::string> subcommands_in(std::string help) {
  help.erase(0, help.find("Subcommands:"));
  std::vector<std::string> names;
  for (std::size_t at = help.find("\n  "); at != std::string::npos;
       at = help.find("\n  ", at + 1)) {
    const std::string name = help.substr(at + 3, help.find_first_of(" \n", at + 3) - at - 3);
    if (!name.empty()) names.push_back(name);  // else a description goes on
  }
  return names;
}

/// What is said of a file that is not written over.
constexpr const char* kThere = "is there already and";

}  // namespace

TEST_CASE("every subcommand that the help names is in the table of commands") {
  std::vector<std::string> names = subcommands_in(run_hqslam("--help").out);
  for (const std::string& name : subcommands_in(run_hqslam("weights --help").out)) {
    names.push_back("weights " + name);
  }
  for (const std::string& name :
       subcommands_in(run_shell(fmt::format("'{}' --help", HQSLAM_LAB_PROGRAM)).out)) {
    names.push_back(name);
  }
  CHECK(names.size() > 15);
  for (const std::string& name : names) {
    CAPTURE(name);
    CHECK(std::ranges::any_of(commands(), [&](const Command& command) {
      return (command.arguments + ' ').starts_with(name + ' ');
    }));
  }
}

TEST_CASE("where nothing can be printed the exit status is an error, and the results are written") {
  const TemporaryDirectory folder;
  for (const Command& command : commands()) {
    if (command.writes()) continue;
    CAPTURE(command.arguments);
    const ProgramResult full = run_hqslam(filled(command.arguments, folder, "") + " >/dev/full");
    CHECK(full.status == 1);
    CHECK(is_one_line(last_line(full.error)));
    CHECK(holds(full.error, "No space left"));
  }
  CHECK(run_hqslam("slam-options >&-").status == 1);
  CHECK(run_hqslam("--help >/dev/full").status == 1);
  CHECK(run_hqslam(run_arguments(folder.file("out")) + " >/dev/full").status == 1);
  CHECK(fs::exists(folder.file("out/report.html")));
  CHECK(run_hqslam(train_arguments(folder, folder.file("trained")) + " >&-").status == 1);
  CHECK_NOTHROW(nn::read_weights(folder.file("trained/weights.npz")));
}

TEST_CASE("with a full disk, or killed, a command leaves what its next run can do with") {
  constexpr Stop kWithoutResults[] = {{0, false}, {200, false}, {1, true}};
  constexpr Stop kOverResults[] = {{1, false}, {0, true}, {200, true}};
  for (const Command& command : commands()) {
    if (!command.writes() || !command.is_quick) continue;
    CAPTURE(command.arguments);
    const TemporaryDirectory folder;
    const std::string out = folder.file("out");
    const std::string arguments = filled(command.arguments, folder, out);
    for (const Stop& stop : kWithoutResults) run_stopped(stop, arguments, folder);
    succeeds(arguments);
    const auto usual = files_of(command, out);
    for (const Stop& stop : kOverResults) {
      const bool was_stopped = run_stopped(stop, arguments, folder);
      if (was_stopped && !command.writes_folder()) CHECK(files_of(command, out) == usual);
      const auto left = files_of(command, out);
      if (!command.writes_as_it_goes) CHECK(left.size() == usual.size());
      for (const auto& [result, contents] : left) {
        CAPTURE(result);
        CHECK(is_whole(out + result));
        if (result.ends_with(".bin")) CHECK(contents == usual.at(result));
      }
    }
    succeeds(arguments);
    CHECK(parts_below(folder.path()).empty());
    for (const auto& [result, contents] : files_of(command, out)) {
      CAPTURE(result);
      if (!tells_times(result)) CHECK(contents == usual.at(result));
    }
  }
}

TEST_CASE("no command replaces what it did not write") {
  for (const Command& command : commands()) {
    for (const std::string& result : command.results) {
      CAPTURE(command.arguments);
      CAPTURE(result);
      const TemporaryDirectory folder;
      const std::string out = folder.file("out");
      if (command.writes_folder()) fs::create_directory(out);
      write_file(out + result, "somebody's own");
      CHECK(missing(refused(filled(command.arguments, folder, out)), {kThere, out + result}) == "");
      CHECK(file_contents(out + result) == "somebody's own");
    }
  }
}

TEST_CASE("only regular files are written over, also among a command's own results") {
  for (const Command& command : commands()) {
    if (!command.writes()) continue;
    CAPTURE(command.arguments);
    const TemporaryDirectory folder;
    const std::string out = folder.file("out");
    const std::string arguments = filled(command.arguments, folder, out);
    if (command.is_quick) succeeds(arguments);
    if (command.writes_folder()) fs::create_directories(out);
    const std::string in_the_way = out + command.results.front();
    fs::remove_all(in_the_way);
    fs::create_symlink(folder.file("elsewhere"), in_the_way);
    CHECK(holds(refused(arguments), kThere));
    CHECK_FALSE(fs::exists(folder.file("elsewhere")));
    fs::remove(in_the_way);
    REQUIRE(mkfifo(in_the_way.c_str(), 0600) == 0);
    CHECK(holds(refused(arguments), kThere));
    CHECK(fs::is_fifo(in_the_way));
    fs::remove(in_the_way);
    fs::create_directory(in_the_way);
    CHECK(holds(refused(arguments), kThere));
    CHECK(fs::is_directory(in_the_way));
  }
}

TEST_CASE("no command replaces what it reads") {
  const TemporaryDirectory folder;
  const std::string out = folder.file("out");
  const std::string drive_of_64 = command_inputs().paths.at("drive64");
  succeeds(run_arguments(out) + " --save-map");
  fs::create_directory_symlink(out, folder.file("link"));
  const std::string options = folder.file("upsampled");
  succeeds(upsample_arguments(options));
  const std::string arrays = folder.file("arrays.npz");
  fs::copy_file(command_inputs().paths.at("weights"), arrays);  // weights are arrays too
  for (const auto& [arguments, read] : std::vector<std::pair<std::string, std::string>>{
           {filled("weights pack {out} {network} --out {out}", folder, arrays), arrays},
           {run_arguments(out) + fmt::format(" --reference '{}/trajectory.tum'", out),
            out + "/trajectory.tum"},
           {run_arguments(folder.file("link")) + fmt::format(" --map '{}/saved_map.npz'", out),
            out + "/saved_map.npz"},
           {fmt::format("upsample '{0}/scans.npy' --method linear --sensor os1-64 --rows 16 "
                        "--out '{0}'",
                        options),
            options + "/scans.npy"},
           {fmt::format("upsample '{0}/bin' --method linear --rows 16 --out '{0}'", options),
            options + "/bin/000000.bin"},
           {fmt::format("simulate --drive block --scans 2 --sensor '{0}/sensor.json' --out '{0}'",
                        drive_of_64),
            drive_of_64 + "/sensor.json"}}) {
    CAPTURE(arguments);
    const std::string before = file_contents(read);
    CHECK(run_hqslam(arguments).status == 2);
    CHECK(file_contents(read) == before);
  }
}

TEST_CASE("a broken input is one line, and nothing is written") {
  const TemporaryDirectory folder;
  const std::string out = folder.file("out");
  for (const Command& command : commands()) {
    for (const std::string& broken : command.with_broken_input) {
      CAPTURE(broken);
      refusal(run_hqslam(filled(broken, folder, out)));
      CHECK(files_of(command, out).empty());
      for (const auto& [kind, path] : command_inputs().paths) {
        if (holds(path, "broken.")) CHECK(file_contents(path) == "what is this?");
      }
    }
  }
}

TEST_CASE("two programs do not write into one folder") {
  const TemporaryDirectory folder;
  const std::string out = folder.file("out");
  fs::create_directory(out);
  const int descriptor = open(out.c_str(), O_RDONLY);
  REQUIRE(flock(descriptor, LOCK_EX | LOCK_NB) == 0);
  for (const Command& command : commands()) {
    if (!command.writes_folder() || !command.locks) continue;
    CAPTURE(command.arguments);
    CHECK(holds(refusal(run_hqslam(filled(command.arguments, folder, out))),
                "another hqslam is writing into it"));
    CHECK(fs::is_empty(out));
  }
  close(descriptor);
  succeeds(simulate_arguments(out));
}

}  // namespace hqslam::test

#pragma once

#include <sys/wait.h>

#include <nlohmann/json.hpp>

#include "hqslam/core/trajectory.h"
#include "tools/parts_of_text.h"

namespace hqslam::test {

namespace fs = std::filesystem;

struct ProgramResult {
  int status = -1;  ///< exit status; -1 if it was killed
  std::string out;
  std::string error;
};

/// Runs commands of a shell, with nothing to read.
inline ProgramResult run_shell(const std::string& commands) {
  const TemporaryDirectory folder;
  const std::string command = "{ " + commands + "\n} >'" + folder.file("out") + "' 2>'" +
                              folder.file("error") + "' </dev/null";
  const int status = std::system(command.c_str());
  ProgramResult result;
  result.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  result.out = file_contents(folder.file("out"));
  result.error = file_contents(folder.file("error"));
  return result;
}

/// The built program that has the subcommand with which the arguments begin.
inline std::string program_of(const std::string& arguments) {
  const std::string command = arguments.substr(0, arguments.find(' '));
  for (const char* lab :
       {"simulate", "train", "table", "compare", "bench", "demo", "evaluate-map"}) {
    if (command == lab) return HQSLAM_LAB_PROGRAM;
  }
  return HQSLAM_PROGRAM;
}

/// A command line for the shell: that program with these arguments.
inline std::string command_line(const std::string& arguments) {
  return fmt::format("'{}' {}", program_of(arguments), arguments);
}

inline ProgramResult run_hqslam(const std::string& arguments) {
  return run_shell(command_line(arguments));
}

inline nlohmann::json json_of(const std::string& path) {
  return nlohmann::json::parse(file_contents(path));
}

/// With its end; a text of one line is its own last one.
inline std::string last_line(const std::string& text) {
  const std::size_t end = text.size() < 2 ? std::string::npos : text.rfind('\n', text.size() - 2);
  return end == std::string::npos ? text : text.substr(end + 1);
}

inline bool is_one_line(const std::string& text) {
  return !text.empty() && text.find('\n') == text.size() - 1;
}

/// The same of arguments that are right.
inline ProgramResult succeeds(const std::string& arguments) {
  ProgramResult result = run_hqslam(arguments);
  CAPTURE(arguments);
  CAPTURE(result.error);
  REQUIRE(result.status == 0);
  return result;
}

/// With wrong ones: the one line on stderr with which they are refused.
inline std::string refused(const std::string& arguments) {
  const ProgramResult result = run_hqslam(arguments);
  CAPTURE(arguments);
  CAPTURE(result.error);
  CHECK(result.status == 2);
  CHECK(is_one_line(result.error));
  return result.error;
}

/// What the last line on stderr says, after others that tell how far it is, of what is refused.
inline std::string refusal(const ProgramResult& result) {
  CAPTURE(result.error);
  CHECK(result.status == 2);
  CHECK(is_one_line(last_line(result.error)));
  return last_line(result.error);
}

// Those of them that take arguments, put together as fmt::format does.
template <typename... Values>
ProgramResult run_hqslam(fmt::format_string<Values...> arguments, Values&&... values) {
  return run_hqslam(fmt::format(arguments, std::forward<Values>(values)...));
}
template <typename... Values>
ProgramResult succeeds(fmt::format_string<Values...> arguments, Values&&... values) {
  return succeeds(fmt::format(arguments, std::forward<Values>(values)...));
}
template <typename... Values>
std::string refused(fmt::format_string<Values...> arguments, Values&&... values) {
  return refused(fmt::format(arguments, std::forward<Values>(values)...));
}

/// A drive through the simulated city, made once per test program with these options: a stack with
/// its truth, .bin and .pcd files. Usually `kDriveScans` scans of an OS1-16.
inline constexpr int kDriveScans = 12;
inline const std::string& simulated_drive(
    const std::string& options = "--sensor os1-16 --scans " + std::to_string(kDriveScans)) {
  static const TemporaryDirectory folder;
  static std::map<std::string, std::string> drives;
  std::string& drive = drives[options];
  if (drive.empty()) {
    drive = folder.file("drive" + std::to_string(drives.size()));
    run_hqslam("simulate --drive block {} --bin --pcd --out '{}'", options, drive);
  }
  return drive;
}

/// Of the position that a run's results have for a drive's last scan, in the frame of the first.
inline double end_error_m(const std::string& results, const std::string& drive) {
  const Trajectory found = read_tum(results + "/trajectory.tum");
  const Trajectory truth = read_tum(drive + "/truth.tum");
  REQUIRE(found.size() == truth.size());
  const auto motion_m = [](const Trajectory& path) -> Eigen::Vector3d {
    return (path.front().T_map_sensor.inverse() * path.back().T_map_sensor).translation();
  };
  return (motion_m(found) - motion_m(truth)).norm();
}

/// The drive that maps are made of.
inline const std::string& drive_of_64() {
  return simulated_drive("--sensor os1-64 --seed 5 --scans 24");
}

}  // namespace hqslam::test

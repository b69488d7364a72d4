#pragma once

#include <fmt/format.h>
#include <sys/wait.h>

#include <cstdlib>
#include <string>

#include "file_contents.h"
#include "temporary_directory.h"

namespace hqslam::test {

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

/// Runs the built program with these arguments, as a shell understands them.
inline ProgramResult run_hqslam(const std::string& arguments) {
  return run_shell(fmt::format("'{}' {}", HQSLAM_PROGRAM, arguments));
}

inline bool holds(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

inline bool is_one_line(const std::string& text) {
  return !text.empty() && text.find('\n') == text.size() - 1;
}

/// A drive of `kDriveScans` scans of an OS1-16 through the simulated city, made once per test
/// program, as a stack with its truth, as .bin and as .pcd files.
inline constexpr int kDriveScans = 12;
inline const std::string& simulated_drive() {
  static const TemporaryDirectory folder;
  static const std::string drive = [] {
    std::string path = folder.file("drive");
    run_hqslam("simulate --drive block --sensor os1-16 --scans " + std::to_string(kDriveScans) +
               " --bin --pcd --out '" + path + "'");
    return path;
  }();
  return drive;
}

}  // namespace hqslam::test

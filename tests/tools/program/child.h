#pragma once

#include <signal.h>
#include <unistd.h>

#include "tools/program/program.h"

namespace hqslam::test {

/// The program in the background, until the end of its scope at the longest.
class Child {
 public:
  /// `streams`: where its output goes, as a shell understands it.
  explicit Child(const std::string& arguments, const std::string& streams = ">/dev/null 2>&1")
      : pid_(fork()) {
    if (pid_ != 0) return;
    // A test that runs in the background ignores it, and would hand that on.
    ::signal(SIGINT, SIG_DFL);
    const std::string command = fmt::format("exec {} {}", command_line(arguments), streams);
    execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
    _exit(127);
  }
  ~Child() { end(SIGKILL); }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  /// Until `condition` holds or the program has ended by itself. Returns whether it has not.
  bool wait_until(const auto& condition) {
    while (!condition()) {
      int status = 0;
      if (waitpid(pid_, &status, WNOHANG) != 0) {
        end_with(status);
        return false;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return true;
  }
  /// Until something is at `path`.
  bool wait_for(const std::string& path) {
    return wait_until([&] { return std::filesystem::exists(path); });
  }

  /// Sends a signal and waits; returns the exit status, -1 if it was killed.
  int end(int signal_number) {
    if (!ended_) kill(pid_, signal_number);
    return wait();
  }
  /// The same, once it has ended by itself.
  int wait() {
    int status = 0;
    if (!ended_ && waitpid(pid_, &status, 0) == pid_) end_with(status);
    return exit_status_;
  }

 private:
  void end_with(int status) {
    ended_ = true;
    exit_status_ = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  pid_t pid_;
  bool ended_ = false;
  int exit_status_ = -1;
};

}  // namespace hqslam::test

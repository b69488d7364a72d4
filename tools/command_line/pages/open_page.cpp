#include "pages/open_page.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>

#include <chrono>
#include <cstring>
#include <filesystem>
#include <thread>

#include "terminal/command_options.h"
#include "terminal/terminal.h"

extern char** environ;

namespace hqslam::tools {
namespace {

#ifdef __APPLE__
constexpr const char* kOpener = "open";
#else
constexpr const char* kOpener = "xdg-open";
#endif
/// Without a browser xdg-open ends in a fraction of it; a browser that it starts may not end.
constexpr std::chrono::milliseconds kLongest(1500);

/// Starts the opener in a session of its own, with no streams. Returns an error's number.
int start(std::string page, pid_t& pid) {
  posix_spawn_file_actions_t streams;
  posix_spawn_file_actions_init(&streams);
  for (const int stream : {0, 1, 2}) {
    posix_spawn_file_actions_addopen(&streams, stream, "/dev/null", O_RDWR, 0);
  }
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t ignored;  // by this program: SIGPIPE
  sigemptyset(&ignored);
  sigaddset(&ignored, SIGPIPE);
  posix_spawnattr_setsigdefault(&attributes, &ignored);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID | POSIX_SPAWN_SETSIGDEF);
  std::string opener = kOpener;
  char* arguments[] = {opener.data(), page.data(), nullptr};
  const int error = posix_spawnp(&pid, kOpener, &streams, &attributes, arguments, environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&streams);
  return error;
}

/// Why it was not opened; empty: it was, as far as can be known.
std::string failure_of_opening(const std::string& page) {
  pid_t pid = 0;
  if (const int error = start(page, pid); error != 0) return std::strerror(error);
  int status = 0;
  const auto deadline = std::chrono::steady_clock::now() + kLongest;
  while (waitpid(pid, &status, WNOHANG) == 0) {
    if (std::chrono::steady_clock::now() > deadline) return "";
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return "";
  return fmt::format("exit status {}", WIFEXITED(status) ? WEXITSTATUS(status) : -1);
}

}  // namespace

void declare_open(Command& command, bool& open, const std::vector<const char*>& needs) {
  command.option("--open", &open, "Show the page in the browser", {.needs = needs});
}

void open_page(const std::string& page) {
  const bool is_address = page.find("://") != std::string::npos;
  const std::string whole = is_address ? page : std::filesystem::absolute(page).string();
  const std::string failure = failure_of_opening(whole);
  if (failure.empty()) return;
  to_stderr("hqslam: {} did not open the page ({}); open {} in a browser\n", kOpener, failure,
            whole);
}

}  // namespace hqslam::tools

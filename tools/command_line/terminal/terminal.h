#pragma once

#include <fmt/format.h>

#include <string_view>
#include <utility>

namespace hqslam::tools {

/// What the program hands back to the shell.
enum ExitStatus : int {
  kOk = 0,
  kFailure = 1,       ///< anything that is not the input's fault
  kWrongInput = 2,    ///< a file or an option; one line on stderr names it
  kInterrupted = 130  ///< Ctrl-C; what was written up to then is valid
};

/// Print what is formatted; control characters in it are shown, not sent. A stream that takes
/// nothing, since it is closed or its disk is full, costs no work: nothing is thrown, and
/// all_printed() returns false. On stdout a text of lines, on stderr one line, of which the middle
/// is left out if it is longer than any path.
void print_lines(std::string_view lines);
void print_message(std::string_view line);

template <typename... Arguments>
void to_stdout(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  print_lines(fmt::format(format, std::forward<Arguments>(arguments)...));
}

template <typename... Arguments>
void to_stderr(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  print_message(fmt::format(format, std::forward<Arguments>(arguments)...));
}

/// To be called before any file is opened. Puts /dev/null where stdin, stdout or stderr is closed:
/// the next file would get its number, and what is printed would be written into it. A reader that
/// goes away does not end the program.
void prepare_standard_streams();

/// Whether stdout took everything; if not, prints so on stderr, unless its reader went away.
bool all_printed();

/// While it lives, the first SIGINT, SIGTERM or SIGHUP (the terminal was closed) only asks for a
/// clean stop; the second one ends the program at once. SIGHUP stays ignored where the program was
/// started so (nohup). One at a time.
class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

  bool stop_requested() const;
};

}  // namespace hqslam::tools

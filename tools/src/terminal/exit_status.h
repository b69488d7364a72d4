#pragma once

namespace hqslam::tools {

/// What the program hands back to the shell.
enum ExitStatus : int {
  kOk = 0,
  kFailure = 1,       ///< anything that is not the input's fault
  kWrongInput = 2,    ///< a file or an option; one line on stderr says which
  kInterrupted = 130  ///< Ctrl-C; what was written up to then is valid
};

}  // namespace hqslam::tools

#include <unistd.h>

#include <cstdlib>

#include "command_line.h"

namespace {

/// Threads of libgomp that wait for each other spin for milliseconds by default and so keep a core
/// from whoever could use it: beside two other busy processes everything took four times as long.
/// With a short spin they soon sleep. libgomp reads this from the environment before main() begins,
/// so the program starts itself once more; a user's own setting stands.
void wait_briefly(char** argv) {
  constexpr const char* kTurns = "2000";
  if (std::getenv("OMP_WAIT_POLICY") != nullptr || std::getenv("GOMP_SPINCOUNT") != nullptr) return;
  if (setenv("GOMP_SPINCOUNT", kTurns, 0) == 0) execv("/proc/self/exe", argv);
  // Still here: it cannot start itself, and threads wait as they do by default.
}

}  // namespace

int main(int argc, char** argv) {
  wait_briefly(argv);
  return hqslam::tools::run_program(argc, argv);
}

#pragma once

#include <cstdint>
#include <string>

#include "recording/recording_choice.h"

namespace CLI {
class App;
}

namespace hqslam::tools {

struct InspectOptions : InputChoice {  ///< sensor empty: as for hqslam upsample
  std::string weights;
  std::int64_t scan = 0;
  std::string out;
};

void declare_inspect(CLI::App& app, InspectOptions& options);
/// Returns an ExitStatus. Throws Error.
int inspect_command(const InspectOptions& options);

}  // namespace hqslam::tools

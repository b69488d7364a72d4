#pragma once

#include <optional>
#include <string>

namespace CLI {
class App;
}

namespace hqslam::tools {

/// What a user says of a recording; every command that opens one asks in the same words.
struct InputChoice {
  std::string input;
  std::string sensor = {};  ///< empty: what the recording says
  std::string stream = {};  ///< of a capture or a bag; empty: the only one with scans
  std::string kept_return = "strongest";
  std::string row_order = "highest-first";
  bool motion_corrected = false;
  std::string capture = {};  ///< "rolling": points without a time have that of their azimuth
  std::string stamps = {};   ///< a file, or "names"; empty: what the recording says
};
/// INPUT, --sensor and what declare_reading declares. `what`, `sensor`: their explanations; empty:
/// the usual ones.
void declare_input(CLI::App& command, InputChoice& choice, const std::string& what = "",
                   const std::string& sensor = "");
/// --stream, --return, --row-order, --motion-corrected, --capture and --stamps alone.
void declare_reading(CLI::App& command, InputChoice& choice);
/// --return alone.
void declare_return(CLI::App& command, std::string& kept_return);

/// What is made of scans before they are used.
struct LiftingChoice {
  std::string upsample = {};  ///< weights file or interpolation; empty: nothing
  int rows = 0;  ///< measured ones; 0: all, or, of an upsampling, its own or every fourth
  std::optional<float> least_confidence = {};  ///< of pixels that are kept; nothing: the weights'
  std::optional<float> tolerance_m = {};       ///< nothing: SuperResolverOptions' own
};
/// --rows, --upsample and what declare_confidence declares.
void declare_lifting(CLI::App& command, LiftingChoice& choice);
/// --confidence and --tolerance.
void declare_confidence(CLI::App& command, LiftingChoice& choice);

/// --threads; 0: what OpenMP chooses.
void declare_threads(CLI::App& command, int& threads);
void use_threads(int threads);

}  // namespace hqslam::tools

#pragma once

#include <optional>
#include <string>

#include "recording/recording_sensor.h"

namespace CLI {
class App;
}

namespace hqslam::tools {

/// INPUT, --sensor and what declare_reading declares. `what`, `sensor`: their explanations; empty:
/// the usual ones.
void declare_input(CLI::App& command, InputChoice& choice, const std::string& what = "",
                   const std::string& sensor = "");
/// --stream, --return, --row-order, --motion-corrected, --capture and --stamps alone.
void declare_reading(CLI::App& command, InputChoice& choice);
/// --return alone.
void declare_return(CLI::App& command, std::string& kept_return);

/// Which pixels of a network that says how sure it is are kept.
struct ConfidenceChoice {
  std::optional<float> least_confidence;  ///< nothing: as the weights say
  std::optional<float> tolerance_m;       ///< nothing: SuperResolverOptions' own
};
/// --confidence and --tolerance.
void declare_confidence(CLI::App& command, ConfidenceChoice& choice);

/// Throws Error if `out` is where the scans of the recording lie: results among them would be read
/// as scans by the next command.
void refuse_to_write_into_recording(const std::string& input, const std::string& out);

/// What is made of scans before they are used.
struct LiftingChoice : ConfidenceChoice {
  int rows = 0;          ///< 0: all
  std::string upsample;  ///< weights file or interpolation; empty: nothing
};
/// --rows, --upsample and what declare_confidence declares.
void declare_lifting(CLI::App& command, LiftingChoice& choice);

/// --threads; 0: what OpenMP chooses.
void declare_threads(CLI::App& command, int& threads);
void use_threads(int threads);

}  // namespace hqslam::tools

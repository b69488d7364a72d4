#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hqslam/core/scan_source.h"
#include "hqslam/pipeline/upsampled_recording.h"
#include "recording/reading.h"
#include "terminal/command_options.h"

namespace hqslam::tools {

/// The options about a recording, the same in every command that opens one.
struct InputChoice {
  std::string input;
  std::string sensor = {};  ///< empty: the recording's own
  std::string stream = {};  ///< of a capture or a bag; empty: the only one with scans
  std::string kept_return = "strongest";
  std::string row_order = "highest-first";
  std::string capture = {};  ///< "rolling" or "corrected"; empty: as RecordingOptions::capture
  std::string stamps = {};   ///< a file, "names" or seconds; empty: the recording's own
  std::string imu = {};      ///< a file of inertial data; empty: what the recording has
  std::string scans = {};    ///< "FROM..TO", indices from 0; empty: all
};
/// INPUT, --sensor and what declare_reading declares. `what`, `sensor`: their explanations; empty:
/// the usual ones.
void declare_input(Command& command, InputChoice& choice, const std::string& what = "",
                   const std::string& sensor = "");
/// --stream, --return, --row-order, --capture (or --motion-corrected) and --stamps alone.
void declare_reading(Command& command, InputChoice& choice);
/// --imu alone.
void declare_imu(Command& command, InputChoice& choice);
/// --scans alone.
void declare_scans(Command& command, InputChoice& choice);
/// The scans of --scans. Throws Error.
ScanRange wanted_scans(const InputChoice& choice);
/// --return alone, and what it means.
void declare_return(Command& command, std::string& kept_return);
recordings::KeptReturn kept_return_named(const std::string& kept_return);

/// The options about upsampling.
struct UpsamplingChoice {
  std::string upsample = {};  ///< weights file or interpolation; empty: nothing
  int rows = 0;  ///< measured ones; 0: all, or, of an upsampling, its own or every fourth
  double spacing_deg = 0.0;                    ///< 0: UpsamplingOptions' own
  std::optional<float> least_confidence = {};  ///< nothing: the weights'
  std::optional<float> tolerance_m = {};       ///< nothing: SuperResolverOptions' own
  std::optional<SensorModel> corrected = {};   ///< UpsamplingOptions::corrected
};
/// Help lines: of --rows, and what a network may be given as.
inline constexpr const char* kRowsHelp = "Use only this many of the sensor's rows, evenly spread";
std::string weights_help();
/// --rows and --upsample.
void declare_upsampling_method(Command& command, UpsamplingChoice& choice);
/// --rows, --upsample and what declare_computed_rows declares.
void declare_upsampling(Command& command, UpsamplingChoice& choice);
/// --spacing, --confidence and --tolerance. needs: options without which they have no effect.
void declare_computed_rows(Command& command, UpsamplingChoice& choice,
                           const std::vector<const char*>& needs = {});

/// Bounds of a number of scans, rows and the like.
inline constexpr std::pair kAnyCount(1, 1000000000);
inline constexpr std::pair kTolerance_m(0.001, 999.0);
/// --threads; 0: what OpenMP chooses.
void declare_threads(Command& command, int& threads);
void use_threads(int threads);

/// A file that `hqslam-lab simulate` or `hqslam upsample` leaves in its folder, if `input` is such
/// a folder and has it; otherwise "".
std::string file_of_drive(const std::string& input, const char* name);

recordings::OpenOptions open_options(const InputChoice& choice);
pipeline::UpsamplingOptions upsampling_options(const UpsamplingChoice& choice);
/// Throws Error where a confidence is asked for of a method that gives none.
void check_confidence(const UpsamplingChoice& choice, const pipeline::Upsampler& upsampler);
/// The recording with what upsamples its scans. Throws Error.
pipeline::UpsampledRecording upsampled_recording(const InputChoice& recording,
                                                 const UpsamplingChoice& upsampling);

/// The number of scans: the source's, or counted by reading a capture or bag to its end.
std::int64_t scans_in(const InputChoice& choice, const ScanSource& source);

/// Prints warnings about the recording to stderr, a line each. input: its path. Returns how many of
/// the source's warnings were printed.
std::size_t print_warnings(const ScanSource& source, const std::string& input);
/// Prints the source's warnings after the first `printed` ones.
void print_later_warnings(const ScanSource& source, std::size_t printed);

/// Throws Error if `out` is the folder of the recording's scans: results among them would be read
/// as scans by the next command.
void refuse_to_write_into_recording(const std::string& input, const std::string& out);

}  // namespace hqslam::tools

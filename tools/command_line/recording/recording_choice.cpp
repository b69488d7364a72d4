#include "recording/recording_choice.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <omp.h>

#include <filesystem>
#include <initializer_list>
#include <limits>
#include <system_error>

#include "files/result_files.h"
#include "hqslam/core/angles.h"
#include "hqslam/core/error.h"
#include "hqslam/core/json_fields.h"
#include "hqslam/core/whole_file.h"
#include "hqslam/core/words.h"
#include "hqslam/nn/upsampler.h"
#include "terminal/terminal.h"

namespace hqslam::tools {

void declare_input(Command& command, InputChoice& choice, const std::string& what,
                   const std::string& sensor) {
  constexpr const char* kUsual =
      "Recording: a capture (.pcap, .pcapng) or bag (.db3, .mcap, .bag) of a sensor, a folder of "
      "KITTI .bin files or of .pcd, .ply, .csv or .txt files, a .npy stack of range images (N x H "
      "x W, float32 metres), or a folder written by hqslam-lab simulate";
  const std::string usual_sensor = fmt::format(
      "Sensor: {}, or a .json file with the beam angles (Ouster's metadata files too), or a "
      "Hesai's "
      ".csv of angles; default: determined from the recording or its points",
      fmt::join(sensor_preset_names(), ", "));
  command
      .option("INPUT", &choice.input, what.empty() ? kUsual : what,
              {.required = true, .given = Given::kFileOrFolder})
      .option("--sensor", &choice.sensor, sensor.empty() ? usual_sensor : sensor);
  declare_reading(command, choice);
}

void declare_imu(Command& command, InputChoice& choice) {
  command.option("--imu", &choice.imu,
                 "File of inertial data by the clock of the scans, in the LiDAR's frame: lines of "
                 "stamp, angular rate x,y,z (rad/s), specific force x,y,z (m/s^2); 'none' leaves "
                 "out those of the recording, which are the default",
                 {.given = Given::kFile, .one_of = {recordings::kNoInertialData}});
}

void declare_scans(Command& command, InputChoice& choice) {
  command.option(
      "--scans", &choice.scans,
      "Use only these scans, FROM..TO by their indices from 0, both included; 100.. from "
      "scan 100 on, ..99 up to scan 99");
}

ScanRange wanted_scans(const InputChoice& choice) {
  ScanRange wanted;
  if (choice.scans.empty()) return wanted;
  const std::string_view text = choice.scans;
  const std::size_t dots = text.find("..");
  const auto take = [](std::string_view word, std::int64_t& index) {
    const auto number = number_from<std::int64_t>(word);
    if (number) index = *number;
    return word.empty() || (number && *number >= 0);
  };
  const bool is_range = dots != std::string_view::npos &&
                        take(text.substr(0, dots), wanted.first) &&
                        take(text.substr(dots + 2), wanted.last) && wanted.first <= wanted.last;
  if (is_range) return wanted;
  throw Error("--scans {}: expected FROM..TO, two indices from 0 of which the first is not larger",
              choice.scans);
}

void declare_reading(Command& command, InputChoice& choice) {
  const auto nothing = [](const std::string& text) {
    return std::string(text.empty() ? "expected a file or 'names', found nothing" : "");
  };
  command.option("--stream", &choice.stream,
                 "Stream of a capture or a bag: a topic, a port, or sender:port");
  declare_return(command, choice.kept_return);
  command
      .option("--row-order", &choice.row_order, "Order of the rows of a .npy stack's images",
              {.shows_default = true, .one_of = {"highest-first", "lowest-first"}})
      .option("--capture", &choice.capture,
              "How scans were captured: rolling, while the sensor turned (points without times get "
              "the time of their azimuth), or corrected for motion (times are not used); default "
              "of points without times: corrected, unless hqslam run finds otherwise, of a .npy "
              "stack: rolling",
              {.one_of = {"rolling", "corrected"}})
      .option("--motion-corrected", [&choice] { choice.capture = "corrected"; },
              "The same as --capture corrected", {.excludes = {"--capture"}})
      .option("--stamps", &choice.stamps,
              "File with the stamp of each scan (seconds, or dates as in KITTI's timestamps.txt), "
              "'names' for the numbers in the files' names, or the seconds from scan to scan where "
              "turns were left out; not for captures and bags, which have their own",
              {.complaint = nothing});
}

void declare_return(Command& command, std::string& kept_return) {
  command.option("--return", &kept_return,
                 "Return that is kept where a sensor sends two for each pulse",
                 {.shows_default = true, .one_of = {"strongest", "last"}});
}

recordings::KeptReturn kept_return_named(const std::string& kept_return) {
  return kept_return == "last" ? recordings::KeptReturn::kLast : recordings::KeptReturn::kStrongest;
}

/// The weights of --upsample without a value: those without a memory, which needs poses.
constexpr const char* kUsualWeights = "du-mix";

std::string weights_help() {
  return fmt::format(
      "a weights file (.npz), or weights that come with hqslam and are chosen by the sensor ({})",
      fmt::join(pipeline::installed_weights_names(), ", "));
}

void declare_upsampling_method(Command& command, UpsamplingChoice& choice) {
  std::vector<std::string> methods = nn::interpolation_names();
  const std::vector<std::string> weights = pipeline::installed_weights_names();
  methods.insert(methods.end(), weights.begin(), weights.end());
  command.option("--rows", &choice.rows, kRowsHelp, {.within = kAnyCount})
      .option(
          "--upsample", &choice.upsample,
          fmt::format("Upsample each scan before SLAM: {}, or an "
                      "interpolation ({}); without a value: {}",
                      weights_help(), fmt::join(nn::interpolation_names(), ", "), kUsualWeights),
          {.given = Given::kFile, .one_of = methods, .if_bare = kUsualWeights});
}

void declare_upsampling(Command& command, UpsamplingChoice& choice) {
  declare_upsampling_method(command, choice);
  declare_computed_rows(command, choice, {"--upsample"});
}

void declare_computed_rows(Command& command, UpsamplingChoice& choice,
                           const std::vector<const char*>& needs) {
  command
      .option("--spacing", &choice.spacing_deg,
              "Widest gap in degrees between two rows of the result, with weights for any sensor "
              "and all rows of the recording; default: 64 rows, or twice those of the recording",
              {.within = std::pair(0.01, 10.0), .needs = needs})
      .option("--confidence", &choice.least_confidence,
              "Least confidence of a computed pixel (du-mix); others are left empty; default: "
              "that of the weights",
              {.within = std::pair(0.0, 1.0), .needs = needs})
      .option("--tolerance", &choice.tolerance_m,
              fmt::format("Range tolerance in metres to which the confidence refers (default: {}); "
                          "with 100 m and more it is the probability of a return at all",
                          nn::SuperResolverOptions{}.tolerance_m),
              {.within = kTolerance_m, .needs = needs});
}

void declare_threads(Command& command, int& threads) {
  command.option("--threads", &threads, "Threads (default: all cores)",
                 {.within = std::pair(1, 256)});
}

void use_threads(int threads) {
  if (threads > 0) omp_set_num_threads(threads);
}

namespace fs = std::filesystem;

namespace {

/// Scans that a simulated drive was to have (it may have been stopped); 0 for other folders.
std::int64_t planned_scans(const std::string& input) {
  const std::string drive = file_of_drive(input, "drive.json");
  if (drive.empty() || file_of_drive(input, "scans.npy").empty()) return 0;
  return scans_of_simulated_drive(drive).value_or(0);
}

/// Scans of a recording that hqslam upsample did not finish; 0 where it did.
std::int64_t scans_to_upsample(const std::string& input) {
  const std::string origin = file_of_drive(input, "upsample.json");
  if (origin.empty()) return 0;
  constexpr std::size_t kMostBytes = 1U << 16U;
  try {
    JsonFields fields(whole_file(origin, "an upsample.json", kMostBytes), origin);
    const bool unfinished = fields.has("complete") && !fields.boolean("complete");
    return unfinished ? fields.integer("scans_in_recording") : 0;
  } catch (const Error&) {
    return 0;  // its scans can be read all the same
  }
}

}  // namespace

std::string file_of_drive(const std::string& input, const char* name) {
  const fs::path path = fs::path(input) / name;
  return fs::is_directory(input) && fs::is_regular_file(path) ? path.string() : "";
}

recordings::OpenOptions open_options(const InputChoice& choice) {
  recordings::OpenOptions options;
  options.sensor = choice.sensor;
  options.stream = choice.stream;
  options.kept_return = kept_return_named(choice.kept_return);
  if (choice.row_order == "lowest-first")
    options.files.row_order = recordings::RowOrder::kLowestFirst;
  if (choice.capture == "rolling") options.files.capture = CaptureTime::kRolling;
  if (choice.capture == "corrected") options.files.capture = CaptureTime::kMotionCorrected;
  options.files.stamps = choice.stamps;
  options.imu = choice.imu;
  return options;
}

pipeline::UpsamplingOptions upsampling_options(const UpsamplingChoice& choice) {
  pipeline::UpsamplingOptions options{
      .method = choice.upsample, .rows = choice.rows, .corrected = choice.corrected};
  options.spacing_rad = radians(choice.spacing_deg);
  options.network.least_confidence = choice.least_confidence;
  if (choice.tolerance_m) options.network.tolerance_m = *choice.tolerance_m;
  return options;
}

void check_confidence(const UpsamplingChoice& choice, const pipeline::Upsampler& upsampler) {
  if (!choice.least_confidence && !choice.tolerance_m) return;
  if (upsampler.has_confidence()) return;
  throw Error(
      "{}: gives no confidence; leave --confidence and --tolerance out, or give weights of kind "
      "du-mix",
      choice.upsample);
}

pipeline::UpsampledRecording upsampled_recording(const InputChoice& recording,
                                                 const UpsamplingChoice& upsampling) {
  pipeline::UpsampledRecording opened = pipeline::open_upsampled(
      recording.input, open_options(recording), upsampling_options(upsampling));
  check_confidence(upsampling, opened.upsampler);
  return opened;
}

std::int64_t scans_in(const InputChoice& choice, const ScanSource& source) {
  if (const auto size = source.size()) return *size;
  return recordings::inspect(choice.input, open_options(choice)).scans;
}

std::size_t print_warnings(const ScanSource& source, const std::string& input) {
  const std::int64_t size = source.size().value_or(std::numeric_limits<std::int64_t>::max());
  const auto warn_if_stopped = [&](const char* what, std::int64_t planned, const char* mends) {
    if (size >= planned) return;
    to_stderr("hqslam: {}: {} was stopped after {} of {} scans; the same {} makes them all\n",
              input, what, size, planned, mends);
  };
  warn_if_stopped("the simulation", planned_scans(input), "hqslam-lab simulate");
  warn_if_stopped("hqslam upsample", scans_to_upsample(input), "command");
  print_later_warnings(source, 0);
  return source.warnings().size();
}

void print_later_warnings(const ScanSource& source, std::size_t printed) {
  const std::vector<std::string> warnings = source.warnings();
  for (std::size_t i = printed; i < warnings.size(); ++i) to_stderr("hqslam: {}\n", warnings[i]);
}

void refuse_to_write_into_recording(const std::string& input, const std::string& out) {
  // KITTI's folders of scans are named by those above them.
  for (const char* scans : {"", "velodyne", "velodyne_points/data"}) {
    std::error_code error;
    if (!fs::equivalent(fs::path(input) / scans, out, error) || error) continue;
    throw Error("{}: holds the recording; give another --out for the results", out);
  }
}

}  // namespace hqslam::tools

#include "recording/recording_choice.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <omp.h>

#include <CLI/CLI.hpp>

#include "hqslam/core/sensor_model.h"
#include "hqslam/nn/upsampler.h"

namespace hqslam::tools {

void declare_input(CLI::App& command, InputChoice& choice, const std::string& what,
                   const std::string& sensor) {
  command
      .add_option(
          "INPUT", choice.input,
          what.empty()
              ? "Capture (.pcap, .pcapng) or bag (.db3, .mcap, .bag) of a sensor, folder of KITTI "
                ".bin files or of .pcd, .ply, .csv or .txt files, .npy stack of range images (N x "
                "H x W, float32 metres), or folder written by hqslam simulate"
              : what)
      ->required()
      ->check(CLI::ExistingPath);
  command.add_option(
      "--sensor", choice.sensor,
      sensor.empty()
          ? fmt::format(
                "{}, or a .json file with the beam angles (Ouster's metadata "
                "files too) or, for packets of an HDL-64E, its db.xml; not needed where the "
                "recording says it",
                fmt::join(sensor_preset_names(), ", "))
          : sensor);
  declare_reading(command, choice);
}

void declare_reading(CLI::App& command, InputChoice& choice) {
  command.add_option("--stream", choice.stream,
                     "Which stream of a capture or a bag: a topic, or a port or sender:port");
  declare_return(command, choice.kept_return);
  command
      .add_option("--row-order", choice.row_order,
                  "Where row 0 of the images of a .npy stack looks")
      ->check(CLI::IsMember({"highest-first", "lowest-first"}))
      ->capture_default_str();
  command.add_flag("--motion-corrected", choice.motion_corrected,
                   "The scans of a .npy stack are already corrected for the sensor's motion");
  command
      .add_option("--capture", choice.capture,
                  "How points without a time were captured: rolling, while the sensor turned (each "
                  "has the time of its azimuth), or corrected for motion (default)")
      ->check(CLI::IsMember({"rolling", "corrected"}));
  command
      .add_option("--stamps", choice.stamps,
                  "File with the stamp of each scan (seconds, or dates as KITTI's "
                  "timestamps.txt), or 'names' for the numbers in the files' names; not of a "
                  "capture or a bag, which have their own")
      ->check([](const std::string& text) {
        return std::string(text.empty() ? "expected a file or 'names', found nothing" : "");
      });
}

void declare_return(CLI::App& command, std::string& kept_return) {
  command
      .add_option("--return", kept_return,
                  "Which one is kept where a sensor sends two returns of a pulse")
      ->check(CLI::IsMember({"strongest", "last"}))
      ->capture_default_str();
}

void declare_lifting(CLI::App& command, LiftingChoice& choice) {
  command
      .add_option("--rows", choice.rows, "Use only this many of the sensor's rows, evenly spread")
      ->check(CLI::Range(1, 1000000000));
  CLI::Option* upsample = command.add_option(
      "--upsample", choice.upsample,
      fmt::format("Fill the rows between the measured ones first: a trained network "
                  "(.npz), or interpolation ({})",
                  fmt::join(nn::interpolation_names(), ", ")));
  upsample->check(CLI::ExistingFile | CLI::IsMember(nn::interpolation_names()));
  declare_confidence(command, choice);
  for (const char* of_upsampling : {"--confidence", "--tolerance"}) {
    command.get_option(of_upsampling)->needs(upsample);
  }
}

void declare_confidence(CLI::App& command, LiftingChoice& choice) {
  command
      .add_option(
          "--confidence", choice.least_confidence,
          "Leave computed pixels empty of which the network (du-mix) is less sure; default: "
          "as the weights say")
      ->check(CLI::Range(0.0, 1.0));
  command
      .add_option("--tolerance", choice.tolerance_m,
                  fmt::format("Sure of what: that the range is right within so many metres "
                              "(default: {}); with 100 m and more, that there is a return at all",
                              nn::SuperResolverOptions{}.tolerance_m))
      ->check(CLI::Range(0.001, 999.0));
}

void declare_threads(CLI::App& command, int& threads) {
  command.add_option("--threads", threads, "Threads (default: all cores)")
      ->check(CLI::Range(1, 256));
}

void use_threads(int threads) {
  if (threads > 0) omp_set_num_threads(threads);
}

}  // namespace hqslam::tools

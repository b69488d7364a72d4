#pragma once

#include <fmt/format.h>

#include <functional>
#include <string>
#include <vector>

#include "hqslam/core/npz.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/nn/network_json.h"
#include "tools/program/arguments.h"
#include "tools/program/untrained_weights.h"

// Every subcommand that writes, as one table: a new one joins the tests of what goes wrong around
// the program by a line in it.

namespace hqslam::test {

/// Files that commands read, made once per test program.
struct WriterInputs {
  TemporaryDirectory folder;
  std::string drive = short_drive();  ///< 16 rows
  std::string drive_of_64 = simulated_drive("--sensor os1-64 --scans 1");
  std::string weights = folder.file("w.npz");   ///< du-mix for them
  std::string arrays = folder.file("a.npz");    ///< the same, to be packed
  std::string network = folder.file("n.json");  ///< their description

  WriterInputs() {
    const nn::Weights made = untrained_weights(sensor_preset("os1-64"), "du-mix");
    write_weights(weights, made);
    NpzArrays all = read_npz(weights);
    all.erase("description");
    write_npz(arrays, all);
    write_file(network, nn::network_json(made.description));
  }
};
inline const WriterInputs& writer_inputs() {
  static const WriterInputs inputs;
  return inputs;
}

struct Writer {
  std::string name;
  /// Writing to `out`, a folder or a file; recipes and drives lie in the other folder.
  std::function<std::string(const TemporaryDirectory&, const std::string& out)> arguments;
  /// What it writes into the folder `out`; empty: `out` itself is the file.
  std::vector<std::string> results = {};
  bool locks = true;     ///< its folder, against a second program
  bool is_quick = true;  ///< takes a second at most; else it is only tried where it is to refuse

  bool writes_folder() const { return !results.empty(); }
  /// Where its first result is.
  std::string result(const std::string& out) const {
    return writes_folder() ? out + "/" + results.front() : out;
  }
};

inline std::vector<Writer> writers() {
  const WriterInputs& in = writer_inputs();
  const std::vector<std::string> of_run = {"trajectory.tum",  "trajectory.kitti", "timings.json",
                                           "covariances.csv", "map.pcd",          "report.html"};
  return {
      {"simulate",
       [](auto&, auto& out) { return simulate_arguments(out); },
       {"scans.npy", "sensor.json", "drive.json", "truth.tum", "truth.kitti", "truth_columns.npy"}},
      {"upsample",
       [](auto&, auto& out) { return upsample_arguments(out); },
       {"scans.npy", "timestamps.txt", "sensor.json", "upsample.json", "bin"}},
      {"run", [](auto&, auto& out) { return run_arguments(out); }, of_run},
      {"run --dense-map",
       [](auto&, auto& out) { return run_arguments(out) + " --dense-map --map-voxel 0.5"; },
       {"dense_map.pcd", "dense_map.ply", "dense_map_above.png", "dense_map_perspective.png"}},
      {"live",
       [](auto&, auto& out) {
         return fmt::format("live --sensor vlp-16 --port 47813 --out '{}'", out);
       },
       of_run, true, false},
      {"map",
       [&in](auto&, auto& out) {
         return fmt::format("map '{0}' --poses '{0}/truth.tum' --map-voxel 0.5 --out '{1}'",
                            in.drive, out);
       },
       {"dense_map.pcd", "dense_map.ply", "dense_map_above.png", "dense_map_perspective.png"}},
      {"table",
       [](auto&, auto& out) { return table_arguments(out); },
       {"table.json", "table.md", "table.html"}},
      {"train",
       [](auto& folder, auto& out) { return train_arguments(folder, out); },
       {"weights.npz", "curve.svg"}},
      {"demo",
       [](auto&, auto& out) { return fmt::format("demo --out '{}'", out); },
       {"demo.html"},
       false,
       false},
      {"inspect",
       [&in](auto&, auto& out) {
         return fmt::format("inspect '{}' --weights '{}' --out '{}'", in.drive_of_64, in.weights,
                            out);
       }},
      {"compare --json",
       [&in](auto&, auto& out) {
         return fmt::format("compare '{}' --json '{}'", in.drive_of_64, out);
       }},
      {"compare --curve",
       [&in](auto&, auto& out) {
         return fmt::format("compare '{}' --weights '{}' --curve '{}'", in.drive_of_64, in.weights,
                            out);
       }},
      {"weights pack",
       [&in](auto&, auto& out) {
         return fmt::format("weights pack '{}' '{}' --out '{}'", in.arrays, in.network, out);
       }},
  };
}

}  // namespace hqslam::test

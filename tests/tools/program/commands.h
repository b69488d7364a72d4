#pragma once

#include "core/recordings/captures.h"
#include "hqslam/core/npz.h"
#include "tools/program/arguments.h"
#include "tools/program/untrained_weights.h"

// Every subcommand, as one table: a new one joins the tests of what goes wrong around the program
// by a line in it.

namespace hqslam::test {

/// Files that commands read, made once per test program.
struct CommandInputs {
  TemporaryDirectory folder;
  std::map<std::string, std::string> paths = {
      {"drive", short_drive()},  // 16 rows
      {"drive64", simulated_drive("--sensor os1-64 --scans 1")},
      {"driven", folder.file("driven")},   // far enough to calibrate by, few columns
      {"weights", folder.file("w.npz")},   // du-mix for drive64
      {"arrays", folder.file("a.npz")},    // the same, to be packed
      {"network", folder.file("n.json")},  // their description
      {"recipe", folder.file("recipe.json")},
      {"capture", folder.file("capture.pcap")},  // of one packet
  };

  CommandInputs() {
    const nn::Weights made = untrained_weights(sensor_preset("os1-64"), "du-mix");
    write_weights(paths.at("weights"), made);
    NpzArrays all = read_npz(paths.at("weights"));
    all.erase("description");
    write_npz(paths.at("arrays"), all);
    write_file(paths.at("network"), nn::network_json(made.description));
    train_arguments(folder, "");  // makes the recipe
    write_file(paths.at("capture"), pcap_bytes({{0, 47814, Payload(64)}}));
    write_sensor_json(preset_with("os1-16", 512), folder.file("sensor.json"));
    succeeds("simulate --drive block --sensor '{}' --scans 75 --out '{}'",
             folder.file("sensor.json"), paths.at("driven"));
    for (const char* kind :
         {"npy", "npz", "json", "pcap", "mcap", "tum", "kitti", "txt", "pcd", "las", "yaml"}) {
      paths[kind] = folder.file(std::string("broken.") + kind);
      write_file(paths[kind], "what is this?");
    }
  }
};
inline const CommandInputs& command_inputs() {
  static const CommandInputs inputs;
  return inputs;
}

/// `text` with every {name} of an input replaced by its path, {out} and {folder} by these.
inline std::string filled(std::string text, const TemporaryDirectory& folder,
                          const std::string& out) {
  std::map<std::string, std::string> paths = command_inputs().paths;
  paths["out"] = out;
  paths["folder"] = folder.path();
  for (const auto& [name, path] : paths) {
    const std::string hole = '{' + name + '}';
    for (std::size_t at = text.find(hole); at != std::string::npos; at = text.find(hole)) {
      text.replace(at, hole.size(), '\'' + path + '\'');
    }
  }
  return text;
}

struct Command {
  std::string arguments;  ///< as filled() takes them
  /// The same with an input that cannot be read.
  std::vector<std::string> with_broken_input = {};
  /// What it writes, each behind {out}: "" is {out} itself, "/map.pcd" is in the folder {out}.
  std::vector<std::string> results = {};
  /// From the first scan on, in place of earlier results; else these stay until new ones are whole.
  bool writes_as_it_goes = false;
  bool is_quick = true;  ///< takes a second at most; else it is only tried where it is to refuse
  bool locks = true;     ///< its folder, against a second program

  bool writes() const { return !results.empty(); }
  bool writes_folder() const { return writes() && results.front().starts_with("/"); }
};

inline const std::vector<Command>& commands() {
  static const std::vector<std::string> of_run = {"/trajectory.tum", "/trajectory.kitti",
                                                  "/timings.json",   "/covariances.csv",
                                                  "/map.pcd",        "/report.html"};
  static const std::vector<std::string> of_map = {"/dense_map.pcd", "/dense_map.ply"};
  static const std::vector<std::string> of_grid = {"/map.pgm", "/map.yaml"};
  static const std::vector<Command> table = {
      {"run {drive} --out {out}",
       {"run {npy} --sensor os1-16 --out {out}", "run {pcap} --out {out}",
        "run {drive} --map {npz} --out {out}", "run {drive} --reference {tum} --out {out}"},
       of_run,
       true},
      {"run {drive} --dense-map --map-voxel 0.5 --out {out}", {}, of_map, true},
      {"run {drive} --occupancy-grid --grid-cell 0.5 --out {out}", {}, of_grid, true},
      {"live --sensor vlp-16 --port 47813 --out {out}",
       {"live --sensor {json} --out {out}"},
       of_run,
       true,
       false},
      {"info {drive}/scans.npy --sensor os1-16", {"info {pcap}"}},
      {"replay {capture}", {"replay {pcap}"}},
      {"demo --out {out}", {}, {"/demo.html"}, true, false, false},
      {"simulate --drive block --sensor os1-16 --scans 3 --bin --out {out}",
       {"simulate --drive block --scans 2 --sensor {json} --out {out}"},
       {"/scans.npy", "/intensity.npy", "/sensor.json", "/drive.json", "/truth.tum", "/truth.kitti",
        "/truth_columns.npy", "/bin"},
       true},
      {"map {drive} --poses {drive}/truth.tum --map-voxel 0.5 --out {out}",
       {"map {drive} --poses {tum} --out {out}"},
       of_map},
      {"map {drive} --poses {drive}/truth.tum --map-voxel 0.5 --occupancy-grid --out {out}",
       {},
       of_grid},
      {"view {drive}/pcd/000000.pcd --out {out}",
       {"view {pcd} --out {out}", "view {las} --out {out}", "view {npz} --out {out}",
        "view {tum} --out {out}", "view {kitti} --out {out}", "view {txt} --out {out}",
        "view {yaml} --out {out}", "view {npy} --sensor os1-16 --out {out}"},
       {""}},
      {"evaluate {drive}/truth.tum {drive}/truth.tum",
       {"evaluate {tum} {tum}", "evaluate {pcd} {pcd}"}},
      {"evaluate-map {drive}/pcd/000000.pcd --drive {drive}",
       {"evaluate-map {pcd} --drive {drive}"}},
      {"compare {drive64} --weights {weights} --json {out}",
       {"compare {npy} --sensor os1-64 --json {out}",
        "compare {drive64} --weights {npz} --json {out}"},
       {""}},
      {"inspect {drive64} --weights {weights} --out {out}",
       {"inspect {drive64} --weights {npz} --out {out}"},
       {""}},
      {"bench --scans 2 --weights {weights}",
       {"bench --scans 2 --weights {npz}"},
       {},
       false,
       false},
      {"table --drives block --methods rows-16 --scans 3 --out {out}",
       {"table --drives {npy} --sensor os1-64 --out {out}",
        "table --drives block --weights {npz} --methods rows-16 --scans 2 --out {out}"},
       {"/table.json", "/table.md", "/table.html"}},
      {"train --config {recipe} --out {out} --drives {folder}/drives",
       {"train --config {json} --out {out}"},
       {"/weights.npz", "/curve.json"}},
      {"calibrate {driven} --path 20 --out {out}.json",
       {"calibrate {npy} --sensor os1-16 --out {out}.json"},
       {".json", ".html"}},
      {"upsample {drive}/pcd --method linear --sensor os1-64 --bin --out {out}",
       {"upsample {mcap} --method linear --out {out}",
        "upsample {drive} --weights {npz} --out {out}"},
       {"/scans.npy", "/intensity.npy", "/timestamps.txt", "/sensor.json", "/upsample.json", "/bin",
        "/truth.tum"},
       true},
      {"weights show {weights}", {"weights show {npz}"}},
      {"weights pack {arrays} {network} --out {out}",
       {"weights pack {npz} {json} --out {out}"},
       {""}},
      {"slam-options"},
  };
  return table;
}

/// Files whose writing did not end.
inline std::vector<std::string> parts_below(const std::filesystem::path& folder) {
  std::vector<std::string> parts;
  for (const std::filesystem::directory_entry& entry :
       std::filesystem::recursive_directory_iterator(folder)) {
    if (holds(entry.path().string(), ".part")) parts.push_back(entry.path());
  }
  return parts;
}

}  // namespace hqslam::test

#include "table/table_plan.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <map>
#include <set>

#include "files/installed_weights.h"
#include "hqslam/core/error.h"
#include "hqslam/nn/upsampler.h"
#include "simulate/simulate_command.h"

namespace hqslam::tools {
namespace {

bool any(const TableMethod&) { return true; }
bool upsamples_rows(const TableMethod& method) { return !method.source.empty(); }
bool sees_all_rows(const TableMethod& method) { return method.rows == kTableAllRows; }

slam::MappingOptions& mapping_of(SlamSetup& setup) { return setup.options.slam_options.mapping; }

namespace fs = std::filesystem;

/// Names of sensors in names of weights: du-mix_os1_16to64.npz.
const std::map<std::string, std::string> kSensorInNames = {{"os1-64", "os1"},
                                                           {"hdl-64e", "hdl64e"}};

bool is_weights_file(const std::string& source) { return fs::path(source).extension() == ".npz"; }

/// Each method, followed by its variants.
std::vector<TableMethod> with_variants(const std::vector<TableMethod>& methods) {
  std::vector<TableMethod> all;
  for (const TableMethod& method : methods) {
    all.push_back(method);
    for (const SlamVariant& variant : slam_variants()) {
      if (!variant.applies(method)) continue;
      TableMethod& with = all.emplace_back(method);
      with.name += fmt::format("+{}", variant.name);
      with.title += fmt::format(", {}", variant.title);
      with.variant = &variant;
    }
  }
  return all;
}

/// The method of that name, itself or as a variant; nothing without one.
std::optional<TableMethod> method_among(const std::vector<TableMethod>& methods,
                                        const std::string& name) {
  for (const TableMethod& method : with_variants(methods)) {
    if (method.name == name) return method;
  }
  return std::nullopt;
}

/// "+NAME, +NAME, ..."
std::string variant_names() {
  std::vector<std::string> names;
  for (const SlamVariant& variant : slam_variants()) {
    names.push_back(fmt::format("+{}", variant.name));
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

/// FILE.npz or FILE.npz+VARIANT.
TableMethod method_of_weights(const std::string& text) {
  const std::size_t plus = text.rfind(".npz+");
  const std::string path = plus == std::string::npos ? text : text.substr(0, plus + 4);
  if (!is_weights_file(path) || !fs::is_regular_file(path)) {
    throw Error("--weights {}: expected a weights file (.npz), found none; check the path", path);
  }
  const std::string name = fs::path(path).stem().string();
  const TableMethod method{name, name, kTableMeasuredRows, path, true};
  if (const auto found = method_among({method}, name + text.substr(path.size()))) return *found;
  throw Error("--weights {}: expected one of these after the file: {}", text, variant_names());
}

TableMethod method_named(const std::string& name) {
  if (const auto found = method_among(table_methods(), name)) return *found;
  throw Error(
      "--methods: expected one of {}, or one of these with a variant that applies to it ({}), "
      "found "
      "'{}'; choose another",
      fmt::join(table_method_names(), ", "), variant_names(), name);
}

bool is_preset(const std::string& drive) {
  const std::vector<std::string> presets = sim::drive_preset_names();
  return std::ranges::find(presets, drive) != presets.end();
}

/// The name of a recording's file or folder; for KITTI, whose scans are in folders "velodyne", the
/// name of the drive.
std::string recording_name(const fs::path& path) {
  const std::string name = path.stem().string();
  return name == "velodyne" ? path.parent_path().filename().string() : name;
}

/// Drives of a sensor with errors have names and folders of their own.
TableDrive simulated_drive(const std::string& drive, std::optional<std::uint64_t> seed,
                           const TableOptions& options) {
  std::string name = seed ? fmt::format("{}-seed-{}", drive, *seed) : drive;
  sim::DriveSpec spec = sim::drive_preset(drive);
  spec.sensor_errors = sim::sensor_errors_named(options.sensor_errors);
  if (spec.sensor_errors != sim::SensorErrors::kNone) name += "-" + options.sensor_errors;
  spec.scans = options.scans.value_or(spec.scans);
  spec.seed = seed.value_or(spec.seed);
  return {name, {.input = (fs::path(options.out) / "drives" / name).string()}, "", spec};
}

TableDrive drive_of(const std::string& drive, const TableOptions& options) {
  if (is_preset(drive)) return simulated_drive(drive, std::nullopt, options);
  if (!fs::exists(drive)) {
    throw Error("--drives: '{}' is neither a simulated drive ({}) nor a file or folder", drive,
                fmt::join(sim::drive_preset_names(), ", "));
  }
  const fs::path path = fs::canonical(drive);
  InputChoice recording = options.reading;
  recording.input = path.string();
  recordings::refuse_idle_options(recording.input, open_options(recording));  // before all work
  return {recording_name(path), recording, options.reference, std::nullopt};
}

/// Every drive from every seed.
std::vector<TableDrive> seeded_drives(const TableOptions& options) {
  std::vector<TableDrive> drives;
  for (const std::string& drive : options.drives) {
    if (!is_preset(drive)) {
      throw Error(
          "--seeds: drives are simulated from seeds; expected one of {}, found '{}' in --drives",
          fmt::join(sim::drive_preset_names(), ", "), drive);
    }
    for (const std::uint64_t seed : seeds_from(options.seeds)) {
      drives.push_back(simulated_drive(drive, seed, options));
    }
  }
  return drives;
}

template <typename Named>
void require_different_names(const std::vector<Named>& all, const char* option) {
  std::set<std::string> names;
  for (const Named& named : all) {
    if (!names.insert(named.name).second) {
      throw Error("{}: expected different names, found '{}' twice; leave one out", option,
                  named.name);
    }
  }
}

void require_one_recording(const TablePlan& plan, const TableOptions& options) {
  const auto recordings =
      std::ranges::count_if(plan.drives, [](const TableDrive& d) { return !d.simulated; });
  if (!options.reference.empty() && recordings != 1) {
    throw Error("--reference: expected one recording in --drives, found {}; give one", recordings);
  }
}

/// Throws Error for a name that is none of the methods.
std::size_t paired_with(const std::vector<TableMethod>& methods, const std::string& against) {
  const std::string& name = against.empty() ? "linear" : against;
  const auto found = std::ranges::find(methods, name, &TableMethod::name);
  if (found != methods.end()) return static_cast<std::size_t>(found - methods.begin());
  if (against.empty()) return 0;
  throw Error(
      "--against: expected one of the rows to compute, found '{}'; add it to --methods or name "
      "another",
      against);
}

}  // namespace

const std::vector<SlamVariant>& slam_variants() {
  using S = SlamSetup;
  constexpr double kNoLimit = std::numeric_limits<double>::max();
  static const std::vector<SlamVariant> variants = {
      {"computed-rows", "computed rows matched too", upsamples_rows,
       [](S& s) { s.sensor.measured_rows.reset(); }},
      // What an upsampling without any error would give, if it is used as the others are.
      {"16-rows", "16 rows of it matched", sees_all_rows,
       [](S& s) { s.sensor.measured_rows = selection_for(s.sensor.rows(), kTableMeasuredRows); }},
      {"whole-map", "the whole map matched", any,
       [](S& s) { mapping_of(s).recent_path_m = kNoLimit; }},
      {"plain-weights", "no robust weights", any,
       [](S& s) { mapping_of(s).trusted_residual_m = kNoLimit; }},
      {"bent-ground", "LeGO-LOAM's ground planes", any,
       [](S& s) { mapping_of(s).max_ground_residual_m = mapping_of(s).max_plane_residual_m; }},
      {"as-published", "LeGO-LOAM as published", any,
       [](S& s) { s.options.slam = pipeline::SlamKind::kLegoLoam; }},
  };
  return variants;
}

SlamSetup slam_setup(const TableMethod& method, const SensorModel& sensor, bool loop_closing) {
  SlamSetup setup{sensor, {}};
  // The clouds are corrected.
  setup.sensor.elevation_correction_rad.clear();
  setup.sensor.range_correction_m.clear();
  setup.options.slam_options.loop_closing.enabled = loop_closing;
  if (method.variant != nullptr) method.variant->change(setup);
  return setup;
}

const std::vector<TableMethod>& table_methods() {
  static const std::vector<TableMethod> methods = {
      {"rows-16", "LiDAR-16", kTableMeasuredRows, "", false},
      {"nearest", "nearest row", kTableMeasuredRows, "nearest", false},
      {"linear", "linear", kTableMeasuredRows, "linear", false},
      {"inverse", "linear in 1/range", kTableMeasuredRows, "inverse", false},
      {"simple-du", "Simple DU", kTableMeasuredRows, "simple-du", false},
      {"simple-du-filter", "Simple DU + OR", kTableMeasuredRows, "simple-du", true},
      {"du-or-no-filter", "DU-OR, last filter off", kTableMeasuredRows, "du-or", false},
      {"du-or", "DU-OR", kTableMeasuredRows, "du-or", true},
      {"du-mix", "DU-Mix", kTableMeasuredRows, "du-mix", false},
      {"rows-64", "LiDAR-64", kTableAllRows, "", false},
  };
  return methods;
}

std::vector<std::string> table_method_names() {
  std::vector<std::string> names;
  for (const TableMethod& method : table_methods()) names.push_back(method.name);
  return names;
}

bool uses_network(const TableMethod& method) {
  return !method.source.empty() && !nn::is_interpolation(method.source);
}

bool is_reference(const TableMethod& method) {
  return method.rows == kTableAllRows && method.variant == nullptr;
}

std::string weights_of(const TableMethod& method, const std::string& sensor_name) {
  if (!uses_network(method)) return "";
  if (is_weights_file(method.source)) return method.source;
  if (const auto sensor = kSensorInNames.find(sensor_name); sensor != kSensorInNames.end()) {
    const std::string name = fmt::format("{}_{}_{}to{}.npz", method.source, sensor->second,
                                         kTableMeasuredRows, kTableAllRows);
    if (const auto path = installed_weights(name)) return *path;
  }
  throw Error(
      "{}: no weights for sensor '{}' come with the program; leave it out of --methods or give "
      "--weights FILE",
      method.name, sensor_name);
}

std::vector<std::vector<TableMethod>> passes_of(const std::vector<TableMethod>& methods) {
  std::vector<std::vector<TableMethod>> passes;
  for (const TableMethod& method : methods) {
    const auto same = std::ranges::find_if(passes, [&](const auto& pass) {
      const TableMethod& other = pass.front();
      // A memory is filled by the poses of the SLAM that it is for.
      return method.rows == other.rows && method.source == other.source &&
             (method.variant == other.variant || !uses_network(method));
    });
    if (same != passes.end()) {
      same->push_back(method);
    } else {
      passes.push_back({method});
    }
  }
  std::ranges::stable_partition(
      passes, [](const auto& pass) { return pass.front().rows == kTableAllRows; });
  return passes;
}

TablePlan plan_table(const TableOptions& options) {
  TablePlan plan;
  plan.over_seeds = !options.seeds.empty();
  if (plan.over_seeds) {
    plan.drives = seeded_drives(options);
  } else {
    for (const std::string& drive : options.drives) plan.drives.push_back(drive_of(drive, options));
  }
  const std::vector<std::string> names =
      options.methods.empty() ? table_method_names() : options.methods;
  for (const std::string& name : names) plan.methods.push_back(method_named(name));
  plan.shown = with_variants(table_methods());
  for (const std::string& weights : options.weights) {
    plan.methods.push_back(method_of_weights(weights));
    plan.shown.insert(std::ranges::find_if(plan.shown, is_reference),
                      plan.methods.back());  // all rows stay the last
  }
  require_different_names(plan.drives, "--drives");
  require_different_names(plan.methods, "--methods");
  require_different_names(plan.shown, "--weights");
  require_one_recording(plan, options);
  if (plan.over_seeds) {
    plan.against = paired_with(plan.methods, options.against);
    plan.shown = plan.methods;
  }
  return plan;
}

}  // namespace hqslam::tools

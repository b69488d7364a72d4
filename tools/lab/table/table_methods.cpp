#include "table/table_methods.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <limits>

#include "hqslam/core/error.h"
#include "hqslam/nn/compare/compared_networks.h"

namespace hqslam::tools {
namespace {

namespace fs = std::filesystem;

slam::MappingOptions& mapping_of(SlamSetup& setup) { return setup.options.slam_options.mapping; }

/// "NAME, NAME, ..."
template <typename Named>
std::string names_of(const std::vector<Named>& all, const char* before = "") {
  std::vector<std::string> names;
  for (const Named& named : all) names.push_back(before + std::string(named.name));
  return fmt::format("{}", fmt::join(names, ", "));
}

/// The method of a name without a variant.
TableMethod plain_method(const std::string& name, const char* option) {
  if (fs::path(name).extension() == ".npz") {
    const std::string stem = fs::path(name).stem().string();
    if (fs::is_regular_file(name)) return {.name = stem, .title = stem, .source = name};
    throw Error("{} {}: expected a weights file, found none; check the path", option, name);
  }
  const auto found = std::ranges::find(table_methods(), name, &TableMethod::name);
  if (found != table_methods().end()) return *found;
  throw Error("{}: expected one of {}, or a weights file (.npz), found '{}'; choose another",
              option, table_method_names(), name);
}

}  // namespace

const std::vector<SlamVariant>& slam_variants() {
  using S = SlamSetup;
  constexpr double kNoLimit = std::numeric_limits<double>::max();
  static const std::vector<SlamVariant> variants = {
      {"as-published", "LeGO-LOAM as published",
       [](S& s) { s.options.slam = pipeline::SlamKind::kLegoLoam; }},
      {"computed-rows", "computed rows matched too", [](S& s) { s.sensor.measured_rows.reset(); }},
      // For rows-64: the result of an upsampling without errors, used as the others are.
      {"16-rows", "16 rows of it matched",
       [](S& s) { s.sensor.measured_rows = selection_for(s.sensor.rows(), kTableMeasuredRows); }},
      {"whole-map", "the whole map matched", [](S& s) { mapping_of(s).recent_path_m = kNoLimit; }},
      {"plain-weights", "no robust weights",
       [](S& s) { mapping_of(s).trusted_residual_m = kNoLimit; }},
      {"bent-ground", "LeGO-LOAM's ground planes",
       [](S& s) { mapping_of(s).max_ground_residual_m = mapping_of(s).max_plane_residual_m; }},
  };
  return variants;
}

const std::vector<TableMethod>& table_methods() {
  constexpr int kFew = kTableMeasuredRows;
  static const std::vector<TableMethod> methods = {
      {kFewRows, "LiDAR-16"},
      {"nearest", "nearest row", kFew, "nearest"},
      {"linear", "linear", kFew, "linear"},
      {"inverse", "linear in 1/range", kFew, "inverse"},
      {"simple-du", "Simple DU", kFew, "simple-du", false},
      {"simple-du-filter", "Simple DU + OR", kFew, "simple-du"},
      {"du-or-no-filter", "DU-OR, last filter off", kFew, "du-or", false},
      {"du-or", "DU-OR", kFew, "du-or"},
      {"du-mix", "DU-Mix", kFew, "du-mix"},
      {kAllRows, "LiDAR-64", kTableAllRows},
  };
  return methods;
}

std::string table_method_names() { return names_of(table_methods()); }

TableMethod method_named(const std::string& text, const char* option) {
  const std::size_t plus = text.rfind('+');
  if (plus == std::string::npos || text.ends_with(".npz")) return plain_method(text, option);
  TableMethod method = plain_method(text.substr(0, plus), option);
  for (const SlamVariant& variant : slam_variants()) {
    if (text.substr(plus + 1) != variant.name) continue;
    method.name += fmt::format("+{}", variant.name);
    method.title += fmt::format(", {}", variant.title);
    method.variant = &variant;
    return method;
  }
  throw Error("{} {}: expected one of these at the end: {}; choose one", option, text,
              names_of(slam_variants(), "+"));
}

pipeline::UpsamplingOptions upsampling_of(const TableMethod& method) {
  pipeline::UpsamplingOptions options{method.source, method.rows};
  options.network.filter_result = method.filtered;
  options.network.architectures = nn::all_architectures();
  return options;
}

SlamSetup slam_setup(const TableMethod& method, const SensorModel& sensor) {
  SlamSetup setup{sensor, {}};
  // The clouds are corrected.
  setup.sensor.elevation_correction_rad.clear();
  setup.sensor.range_correction_m.clear();
  setup.options.slam_options.loop_closing.enabled = false;
  if (method.variant != nullptr) method.variant->change(setup);
  return setup;
}

}  // namespace hqslam::tools

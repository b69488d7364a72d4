#include "table/table_methods.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

#include "hqslam/core/error.h"
#include "hqslam/nn/compare/compared_networks.h"

namespace hqslam::tools {
namespace {

namespace fs = std::filesystem;

/// The method of a name without kAsPublished.
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

std::string table_method_names() {
  std::vector<std::string> names;
  for (const TableMethod& method : table_methods()) names.push_back(method.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

TableMethod method_named(const std::string& text, const char* option) {
  const std::size_t plus = text.rfind('+');
  if (plus == std::string::npos || text.ends_with(".npz")) return plain_method(text, option);
  if (text.substr(plus) != kAsPublished) {
    throw Error("{} {}: expected no '+' but in {}; leave it out", option, text, kAsPublished);
  }
  TableMethod method = plain_method(text.substr(0, plus), option);
  method.name += kAsPublished;
  method.title += ", LeGO-LOAM";
  method.slam = pipeline::SlamKind::kLegoLoam;
  return method;
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
  setup.options.slam = method.slam;
  return setup;
}

}  // namespace hqslam::tools

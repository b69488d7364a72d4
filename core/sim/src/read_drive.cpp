#include "hqslam/sim/read_drive.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "hqslam/core/error.h"
#include "hqslam/core/json_limits.h"
#include "hqslam/core/whole_file.h"
#include "spec_numbers.h"

namespace hqslam::sim {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostBytes = 1U << 16U;

[[noreturn]] void complain(const std::string& path, const std::string& what) {
  throw Error(fmt::format("{}: {}; give a folder written by hqslam simulate, by this version of it",
                          path, what));
}

template <typename Value>
Value field(const Json& json, const char* name, const std::string& path) {
  const auto found = json.find(name);
  const bool fits =
      found != json.end() && (std::is_same_v<Value, std::string> ? found->is_string()
                              : std::is_floating_point_v<Value>  ? found->is_number()
                              : std::is_unsigned_v<Value>        ? found->is_number_unsigned()
                                                                 : found->is_number_integer());
  if (!fits) complain(path, fmt::format("expected a field '{}', found none that fits", name));
  return found->get<Value>();
}

}  // namespace

DriveSpec read_drive_json(const std::string& path) {
  const std::string text = whole_file(path, "a drive.json written by hqslam simulate", kMostBytes);
  check_json_limits(text, path);
  const Json json = Json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (!json.is_object()) complain(path, "expected a JSON object");
  DriveSpec spec;
  spec.name = field<std::string>(json, "name", path);
  spec.seed = field<std::uint64_t>(json, "seed", path);
  spec.scans = field<std::int64_t>(json, "scans", path);
  for_each_number(spec, [&](const char* part, const char* name, double& value, double /*low*/,
                            double /*high*/) {
    if (!json.contains(part)) return;
    if (!json[part].is_object()) {
      complain(path, fmt::format("expected '{}' to be an object", part));
    }
    value = field<double>(json[part], name, path);
  });
  validate(spec);
  return spec;
}

}  // namespace hqslam::sim

#include "hqslam/sim/read_drive.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "hqslam/core/error.h"
#include "hqslam/core/json_limits.h"
#include "hqslam/core/whole_file.h"

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

/// The fields of an object, of which none is missing.
class Part {
 public:
  Part(const Json& json, const char* name, const std::string& path) : json_(json), path_(path) {
    if (!json.is_object()) complain(path, fmt::format("expected '{}' to be an object", name));
  }
  void read(const char* name, double& value) const { value = field<double>(json_, name, path_); }

 private:
  const Json& json_;
  const std::string& path_;
};

void read_mount(const Json& json, const std::string& path, SensorMount& mount) {
  const Part part(json, "mount", path);
  part.read("sensor_height_m", mount.sensor_height_m);
  part.read("mount_roll_rad", mount.mount_roll_rad);
  part.read("mount_pitch_rad", mount.mount_pitch_rad);
}

void read_conditions(const Json& json, const std::string& path, SensingConditions& conditions) {
  const Part part(json, "conditions", path);
  part.read("extra_range_noise_m", conditions.extra_range_noise_m);
  part.read("dropout_share", conditions.dropout_share);
  part.read("extinction_per_m", conditions.extinction_per_m);
  part.read("airborne_share", conditions.airborne_share);
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
  if (json.contains("mount")) read_mount(json["mount"], path, spec.mount);
  if (json.contains("conditions")) read_conditions(json["conditions"], path, spec.conditions);
  validate(spec);
  return spec;
}

}  // namespace hqslam::sim

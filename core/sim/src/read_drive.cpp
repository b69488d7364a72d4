#include "hqslam/sim/read_drive.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "hqslam/core/error.h"
#include "hqslam/core/json_limits.h"

namespace hqslam::sim {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::uintmax_t kMostBytes = 1U << 16U;

[[noreturn]] void complain(const std::string& path, const std::string& what) {
  throw Error(fmt::format("{}: {}; give a folder written by hqslam simulate, by this version of it",
                          path, what));
}

std::string text_of(const std::string& path) {
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(path, error);
  if (error || bytes > kMostBytes) {
    complain(path, error ? "expected a file, found none"
                         : fmt::format("expected at most {} bytes, found {}", kMostBytes, bytes));
  }
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

template <typename Value>
Value field(const Json& json, const char* name, const std::string& path) {
  const auto found = json.find(name);
  const bool fits =
      found != json.end() && (std::is_same_v<Value, std::string> ? found->is_string()
                              : std::is_unsigned_v<Value>        ? found->is_number_unsigned()
                                                                 : found->is_number_integer());
  if (!fits) complain(path, fmt::format("expected a field '{}', found none that fits", name));
  return found->get<Value>();
}

}  // namespace

DriveSpec read_drive_json(const std::string& path) {
  const std::string text = text_of(path);
  check_json_limits(text, path);
  const Json json = Json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (!json.is_object()) complain(path, "expected a JSON object");
  DriveSpec spec;
  spec.name = field<std::string>(json, "name", path);
  spec.seed = field<std::uint64_t>(json, "seed", path);
  spec.scans = field<std::int64_t>(json, "scans", path);
  return spec;
}

}  // namespace hqslam::sim

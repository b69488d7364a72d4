#include "hqslam/core/json_limits.h"

#include <fmt/format.h>

#include <array>
#include <nlohmann/json.hpp>

#include "hqslam/core/error.h"

namespace hqslam {

void check_json_limits(const std::string& text, const std::string& source) {
  using Json = nlohmann::json;
  constexpr int kMaxDepth = 32;
  constexpr int kMaxFields = 1000;
  const auto fail = [&](const std::string& expected) {
    throw Error(
        fmt::format("{}: expected JSON with {}, found more; correct the text", source, expected));
  };
  std::array<int, kMaxDepth + 1> fields{};  // of the value that is open at each depth
  const auto check = [&](int depth, Json::parse_event_t event, Json& /*value*/) {
    if (event == Json::parse_event_t::object_start || event == Json::parse_event_t::array_start) {
      if (depth >= kMaxDepth) fail(fmt::format("values at most {} levels deep", kMaxDepth));
      fields[static_cast<std::size_t>(depth) + 1] = 0;
    }
    if (event == Json::parse_event_t::key &&
        ++fields[static_cast<std::size_t>(depth)] > kMaxFields) {
      fail(fmt::format("at most {} fields per object", kMaxFields));
    }
    return true;
  };
  [[maybe_unused]] const Json whole = Json::parse(text, check, /*allow_exceptions=*/false);
}

}  // namespace hqslam

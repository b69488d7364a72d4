#include "hqslam/core/json_fields.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "hqslam/core/error.h"
#include "hqslam/core/excerpt.h"

namespace hqslam {

namespace {

using Json = nlohmann::ordered_json;

/// The beginning of a value, fit for a message of one line.
std::string shown(const Json& value) {
  return excerpt(value.dump(-1, ' ', true, Json::error_handler_t::replace));
}

}  // namespace

Json parsed_json(const std::string& text, const std::string& source) {
  check_json_limits(text, source);
  try {
    return Json::parse(text);
  } catch (const Json::parse_error& error) {
    throw Error("{}: expected JSON, found something else at byte {}; correct the text", source,
                error.byte);
  } catch (const Json::exception&) {
    throw Error(
        "{}: expected JSON with finite numbers, found a number out of range; correct the text",
        source);
  }
}

JsonFields::JsonFields(const std::string& text, std::string source, const std::string& mend)
    : source_(std::move(source)), mend_(mend.empty() ? "" : "; " + mend) {
  object_ = parsed_json(text, source_);
  if (!object_.is_object()) {
    throw Error("{}: expected a JSON object, found {}", source_, shown(object_));
  }
}

void JsonFields::complain(const std::string& field, const std::string& expected) const {
  complain(field, expected, has(field) ? shown(object_[field]) : "nothing");
}

void JsonFields::complain(const std::string& field, const std::string& expected,
                          const std::string& found) const {
  throw Error("{}: field '{}': expected {}, found {}{}", source_, field, expected, found, mend_);
}

const Json& JsonFields::get(const std::string& field, const std::string& expected, IsType is_type) {
  if (!object_.contains(field)) complain(field, expected);
  read_.insert(field);
  const Json& value = object_[field];
  if (is_type != nullptr && !(value.*is_type)()) complain(field, expected);
  return value;
}

double JsonFields::number(const std::string& field) {
  return number(get(field, "a number"), field);
}

double JsonFields::number(const Json& value, const std::string& field) const {
  if (!value.is_number()) complain(field, "a number", shown(value));
  return value.get<double>();
}

std::int64_t JsonFields::integer(const std::string& field) {
  constexpr double kLargest = 9e15;  // a double holds every whole number up to here
  const double value = number(field);
  if (value != std::floor(value) || std::abs(value) > kLargest) complain(field, "a whole number");
  return static_cast<std::int64_t>(value);
}

std::uint64_t JsonFields::unsigned_integer(const std::string& field) {
  return get(field, "a whole number of at least 0", &Json::is_number_unsigned).get<std::uint64_t>();
}

int JsonFields::small_integer(const std::string& field) {
  constexpr std::int64_t kLargest = 1'000'000;
  const std::int64_t value = integer(field);
  if (std::abs(value) > kLargest) complain(field, "a whole number of at most a million");
  return static_cast<int>(value);
}

bool JsonFields::boolean(const std::string& field) {
  return get(field, "true or false", &Json::is_boolean).get<bool>();
}

std::string JsonFields::text(const std::string& field) {
  return get(field, "a text", &Json::is_string).get<std::string>();
}

std::vector<int> JsonFields::integers(const std::string& field) {
  const std::string expected = "a list of whole numbers";
  std::vector<int> values;
  for (const Json& value : get(field, expected, &Json::is_array)) {
    if (!value.is_number_integer() || std::abs(value.get<double>()) > 1e6)
      complain(field, expected);
    values.push_back(value.get<int>());
  }
  return values;
}

std::vector<double> JsonFields::numbers(const std::string& field) {
  std::vector<double> values;
  for (const Json& value : get(field, "a list of numbers", &Json::is_array)) {
    values.push_back(number(value, fmt::format("{}[{}]", field, values.size())));
  }
  return values;
}

std::size_t JsonFields::choice(const std::string& field, const std::vector<std::string>& names) {
  const std::string value = text(field);
  const auto found = std::ranges::find(names, value);
  if (found == names.end()) complain(field, fmt::format("one of {}", fmt::join(names, ", ")));
  return static_cast<std::size_t>(found - names.begin());
}

JsonFields JsonFields::object(const std::string& field) {
  return {get(field, "an object", &Json::is_object), fmt::format("{}: {}", source_, field), mend_};
}

std::vector<JsonFields> JsonFields::objects(const std::string& field) {
  const std::string expected = "a list of objects";
  std::vector<JsonFields> values;
  for (const Json& value : get(field, expected, &Json::is_array)) {
    if (!value.is_object()) complain(field, expected);
    values.push_back(
        JsonFields(value, fmt::format("{}: {}[{}]", source_, field, values.size()), mend_));
  }
  return values;
}

std::string JsonFields::dumped(const std::string& field) {
  return get(field, "a value").dump(1, ' ', true, Json::error_handler_t::replace);
}

void JsonFields::finish() const {
  for (const auto& item : object_.items()) {
    if (!read_.contains(item.key())) {
      throw Error("{}: unknown field '{}'; take it out or correct its name", source_,
                  excerpt(item.key()));
    }
  }
}

void check_json_limits(const std::string& text, const std::string& source) {
  using Sorted = nlohmann::json;
  constexpr int kMaxDepth = 32;
  constexpr int kMaxFields = 1000;
  const auto fail = [&](const std::string& expected) {
    throw Error("{}: expected JSON with {}, found more; correct the text", source, expected);
  };
  std::array<int, kMaxDepth + 1> fields{};  // of the value that is open at each depth
  const auto check = [&](int depth, Sorted::parse_event_t event, Sorted& /*value*/) {
    if (event == Sorted::parse_event_t::object_start ||
        event == Sorted::parse_event_t::array_start) {
      if (depth >= kMaxDepth) fail(fmt::format("values at most {} levels deep", kMaxDepth));
      fields[static_cast<std::size_t>(depth) + 1] = 0;
    }
    if (event == Sorted::parse_event_t::key &&
        ++fields[static_cast<std::size_t>(depth)] > kMaxFields) {
      fail(fmt::format("at most {} fields per object", kMaxFields));
    }
    return true;
  };
  [[maybe_unused]] const Sorted whole = Sorted::parse(text, check, /*allow_exceptions=*/false);
}

}  // namespace hqslam

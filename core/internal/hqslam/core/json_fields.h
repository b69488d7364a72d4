#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <type_traits>
#include <vector>

namespace hqslam {

/// Throws Error if a JSON text nests its values deeper than 32 or gives one object more than 1000
/// fields: values are written and copied by recursion, and an object whose fields keep their order
/// is read by comparing each name with all before it. A text that is not JSON passes; its parser
/// reports what is wrong. `source` stands for the file in messages.
void check_json_limits(const std::string& text, const std::string& source);

/// Any JSON value. Throws Error for other text, for numbers that no double holds and for what
/// exceeds check_json_limits; `source` stands for the file in messages.
nlohmann::ordered_json parsed_json(const std::string& text, const std::string& source);

/// A JSON object read field by field. Every complaint is one Error naming source, field, expected
/// and found; `finish` refuses fields that were not read.
class JsonFields {
 public:
  /// Parses text that must be an object. `source` stands for the file in messages; `mend` ends
  /// messages about fields with how to mend them.
  JsonFields(const std::string& text, std::string source, const std::string& mend = "");

  bool has(const std::string& field) const { return object_.contains(field); }
  bool is_object(const std::string& field) const {
    return has(field) && object_[field].is_object();
  }
  std::int64_t integer(const std::string& field);
  std::uint64_t unsigned_integer(const std::string& field);
  int small_integer(const std::string& field);  ///< at most a million
  double number(const std::string& field);
  bool boolean(const std::string& field);
  std::string text(const std::string& field);
  std::vector<int> integers(const std::string& field);
  std::vector<double> numbers(const std::string& field);
  /// One of `names`; returns which.
  std::size_t choice(const std::string& field, const std::vector<std::string>& names);
  JsonFields object(const std::string& field);
  std::vector<JsonFields> objects(const std::string& field);
  /// The object of this name, or these fields: newer files may group what older ones keep flat.
  JsonFields section(const std::string& field) { return is_object(field) ? object(field) : *this; }
  /// The field as JSON text.
  std::string dumped(const std::string& field);

  /// Reads the field into `value`, which is kept where the field is missing.
  template <typename Value>
  void optional(const std::string& field, Value& value) {
    if (!has(field)) return;
    if constexpr (std::is_same_v<Value, bool>) {
      value = boolean(field);
    } else if constexpr (std::is_same_v<Value, int>) {
      value = small_integer(field);
    } else if constexpr (std::is_signed_v<Value> && std::is_integral_v<Value>) {
      value = integer(field);
    } else if constexpr (std::is_integral_v<Value>) {
      value = unsigned_integer(field);
    } else {
      value = static_cast<Value>(number(field));
    }
  }

  /// Throws Error if there is a field that was not read.
  void finish() const;

  [[noreturn]] void complain(const std::string& field, const std::string& expected) const;

 private:
  JsonFields(nlohmann::ordered_json object, std::string source, std::string mend)
      : object_(std::move(object)), source_(std::move(source)), mend_(std::move(mend)) {}
  using IsType = bool (nlohmann::ordered_json::*)() const noexcept;
  /// The field's value. Throws Error if it is missing or is_type, where given, is false for it.
  const nlohmann::ordered_json& get(const std::string& field, const std::string& expected,
                                    IsType is_type = nullptr);
  double number(const nlohmann::ordered_json& value, const std::string& field) const;
  [[noreturn]] void complain(const std::string& field, const std::string& expected,
                             const std::string& found) const;

  nlohmann::ordered_json object_;
  std::string source_;
  std::string mend_;
  std::set<std::string> read_;
};

}  // namespace hqslam

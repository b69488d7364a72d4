#pragma once

#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

namespace hqslam::nn {

/// Any JSON value. Throws Error for a text that is none or goes beyond check_json_limits; `source`
/// stands for the file in messages.
nlohmann::ordered_json parsed_json(const std::string& text, const std::string& source);

/// A JSON object read field by field. Every complaint is one Error naming source, field, expected
/// and found; fields that nobody asked for are complained about by `finish`.
class JsonFields {
 public:
  /// Parses text that must be an object. `source` stands for the file in messages.
  JsonFields(const std::string& text, std::string source);

  bool has(const std::string& field) const { return object_.contains(field); }
  bool is_object(const std::string& field) const {
    return has(field) && object_[field].is_object();
  }
  std::int64_t integer(const std::string& field);
  double number(const std::string& field);
  bool boolean(const std::string& field);
  std::string text(const std::string& field);
  std::vector<int> integers(const std::string& field);
  /// One of `names`; returns which.
  std::size_t choice(const std::string& field, const std::vector<std::string>& names);
  JsonFields object(const std::string& field);
  std::vector<JsonFields> objects(const std::string& field);
  /// The field as JSON text.
  std::string dumped(const std::string& field);

  // The same, keeping `value` where the field is missing.
  void optional(const std::string& field, int& value);
  void optional(const std::string& field, std::int64_t& value);
  void optional(const std::string& field, std::uint64_t& value);
  void optional(const std::string& field, float& value);
  void optional(const std::string& field, double& value);
  void optional(const std::string& field, bool& value);

  /// Throws Error if there is a field that was not read.
  void finish() const;

  [[noreturn]] void complain(const std::string& field, const std::string& expected) const;

 private:
  JsonFields(nlohmann::ordered_json object, std::string source)
      : object_(std::move(object)), source_(std::move(source)) {}
  const nlohmann::ordered_json& get(const std::string& field, const std::string& expected);

  nlohmann::ordered_json object_;
  std::string source_;
  std::set<std::string> read_;
};

}  // namespace hqslam::nn

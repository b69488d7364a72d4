#include "hqslam/core/json_limits.h"

#include <fmt/format.h>

#include <cstddef>
#include <nlohmann/json.hpp>
#include <vector>

#include "hqslam/core/error.h"

namespace hqslam {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxDepth = 32;
constexpr std::size_t kMaxFields = 1000;

/// Is told of each part of a text as it is met; nothing is kept but a count per open object.
class LimitChecker : public nlohmann::json_sax<Json> {
 public:
  explicit LimitChecker(const std::string& source) : source_(source) {}

  bool null() override { return true; }
  bool boolean(bool /*value*/) override { return true; }
  bool number_integer(number_integer_t /*value*/) override { return true; }
  bool number_unsigned(number_unsigned_t /*value*/) override { return true; }
  bool number_float(number_float_t /*value*/, const string_t& /*text*/) override { return true; }
  bool string(string_t& /*value*/) override { return true; }
  bool binary(binary_t& /*value*/) override { return true; }
  bool start_object(std::size_t /*elements*/) override { return open(); }
  bool end_object() override { return close(); }
  bool start_array(std::size_t /*elements*/) override { return open(); }
  bool end_array() override { return close(); }
  bool parse_error(std::size_t /*byte*/, const std::string& /*token*/,
                   const nlohmann::detail::exception& /*error*/) override {
    return false;
  }

  bool key(string_t& /*name*/) override {
    if (++fields_.back() > kMaxFields)
      fail(fmt::format("at most {} fields per object", kMaxFields));
    return true;
  }

 private:
  bool open() {
    fields_.push_back(0);
    if (fields_.size() > kMaxDepth) fail(fmt::format("values at most {} levels deep", kMaxDepth));
    return true;
  }

  bool close() {
    fields_.pop_back();
    return true;
  }

  [[noreturn]] void fail(const std::string& expected) const {
    throw Error(
        fmt::format("{}: expected JSON with {}, found more; correct the text", source_, expected));
  }

  const std::string& source_;
  std::vector<std::size_t> fields_;  ///< of each open object; of an open array 0
};

}  // namespace

void check_json_limits(const std::string& text, const std::string& source) {
  LimitChecker checker(source);
  Json::sax_parse(text, &checker);
}

}  // namespace hqslam

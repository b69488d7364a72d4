#include "files/npy_format.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <string_view>

#include "hqslam/core/error.h"
#include "hqslam/core/excerpt.h"
#include "hqslam/core/npy.h"

namespace hqslam {

namespace {

constexpr std::string_view kMagic = "\x93NUMPY";
constexpr std::size_t kMaxHeaderBytes = 65536;
constexpr std::size_t kMaxDimensions = 32;

template <typename... Values>
[[noreturn]] void fail_in_npy(const std::string& path, fmt::format_string<Values...> complaint,
                              Values&&... values) {
  throw Error("{}: {}; save the array again with numpy.save", path,
              fmt::format(complaint, std::forward<Values>(values)...));
}

/// The dictionary literal of a header as JSON.
std::string as_json(const std::string& literal) {
  constexpr std::string_view kPython = "'()";
  constexpr std::string_view kJson = "\"[]";
  std::string json;
  for (const char c : literal) {
    if (c == ')' || c == '}') {  // Python lets a comma come before them
      json.erase(json.find_last_not_of(' ') + 1);
      if (json.ends_with(',')) json.pop_back();
    }
    const std::size_t found = kPython.find(c);
    json += found == std::string_view::npos ? c : kJson[found];
  }
  for (const char* word : {"True", "False"}) {
    const std::size_t found = json.find(word);
    if (found != std::string::npos) json[found] = *word == 'T' ? 't' : 'f';
  }
  return json;
}

NpyHeader header_of(const std::string& literal, const std::string& path) {
  const auto require = [&](bool fits, std::string_view expected) {
    if (fits) return;
    fail_in_npy(path, "damaged .npy header: expected {}, found {}", expected,
                excerpt(literal, 120));
  };
  require(literal.find('[') == std::string::npos,
          "one number per element, not an array of structures, and a shape in parentheses");
  const auto json = nlohmann::json::parse(as_json(literal), nullptr, /*allow_exceptions=*/false);
  require(json.is_object() && json.size() == 3 && std::ranges::count(literal, ':') == 3,
          "a dictionary of descr, fortran_order and shape, each once");
  const nlohmann::json dtype = json.value("descr", nlohmann::json());
  require(dtype.is_string(), "a quoted word for 'descr'");
  const nlohmann::json order = json.value("fortran_order", nlohmann::json());
  require(order.is_boolean(), "True or False for 'fortran_order'");
  const nlohmann::json shape = json.value("shape", nlohmann::json());
  require(shape.is_array() && shape.size() <= kMaxDimensions, "at most 32 dimensions in 'shape'");
  NpyHeader header{dtype, order, {}};
  for (const nlohmann::json& size : shape) {
    constexpr std::uint64_t kLargest = std::numeric_limits<std::int64_t>::max();
    require(size.is_number_unsigned() && size.get<std::uint64_t>() <= kLargest,
            "a size in 'shape' that is not negative and below 2^63");
    header.shape.push_back(size);
  }
  return header;
}

}  // namespace

std::string npy_shape_text(const std::vector<std::int64_t>& shape) {
  return fmt::format("({}{})", fmt::join(shape, ", "), shape.size() == 1 ? "," : "");
}

std::string npy_header_bytes(const std::string& dtype, const std::vector<std::int64_t>& shape,
                             std::size_t least_bytes) {
  constexpr std::size_t kPreamble = 10;
  constexpr std::size_t kAlignment = 64;
  std::string text = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': {}, }}", dtype,
                                 npy_shape_text(shape));
  const std::size_t needed = std::max(kPreamble + text.size() + 1, least_bytes);
  text.resize((needed + kAlignment - 1) / kAlignment * kAlignment - kPreamble - 1, ' ');
  text += '\n';
  std::string header("\x93NUMPY\x01\x00", 8);
  header += static_cast<char>(text.size() & 0xFF);
  header += static_cast<char>(text.size() >> 8);
  return header + text;
}

std::optional<std::int64_t> npz_element_bytes(const std::string& dtype) {
  if (dtype == "<f8" || dtype == "<i8") return 8;
  if (dtype == "<f4" || dtype == "<i4") return 4;
  if (dtype == "|u1" || dtype == "|i1" || dtype == "|b1") return 1;
  return std::nullopt;
}

std::optional<std::int64_t> npz_element_count(const std::vector<std::int64_t>& shape) {
  constexpr std::int64_t kMaxElements = std::int64_t{1} << 59;
  if (std::ranges::any_of(shape, [](std::int64_t size) { return size < 0; })) {
    return std::nullopt;
  }
  // A size of 0 anywhere makes the array empty, however large the others are.
  if (std::ranges::find(shape, 0) != shape.end()) return 0;
  std::int64_t count = 1;
  for (const std::int64_t size : shape) {
    if (size > kMaxElements / count) return std::nullopt;
    count *= size;
  }
  return count;
}

NpyHeader read_npy_header(std::istream& stream, const std::string& path) {
  stream.seekg(0);
  std::array<char, 12> start{};
  stream.read(start.data(), 8);
  if (!stream || std::string_view(start.data(), kMagic.size()) != kMagic) {
    fail_in_npy(path, "expected an .npy file (it begins with \\x93NUMPY), found something else");
  }
  const int version = static_cast<unsigned char>(start[6]);
  if (version < 1 || version > 3 || start[7] != 0) {
    fail_in_npy(path, "expected .npy version 1.0, 2.0 or 3.0, found {}.{}", version,
                static_cast<unsigned char>(start[7]));
  }
  const std::size_t size_bytes = version == 1 ? 2 : 4;
  stream.read(start.data() + 8, static_cast<std::streamsize>(size_bytes));
  std::uint32_t length = 0;
  std::memcpy(&length, start.data() + 8, size_bytes);
  if (!stream || length > kMaxHeaderBytes) {
    fail_in_npy(path, "expected an .npy header of at most {} bytes, found {}", kMaxHeaderBytes,
                stream ? fmt::format("{} bytes", length) : "the end of the file");
  }
  std::string text(length, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(length));
  if (!stream) {
    fail_in_npy(path, "truncated: expected an .npy header of {} bytes, found {} bytes", length,
                stream.gcount());
  }
  NpyHeader header = header_of(text, path);
  header.data_offset_bytes = static_cast<std::int64_t>(8 + size_bytes + length);
  return header;
}

}  // namespace hqslam

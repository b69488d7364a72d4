#include <fmt/format.h>

#include <array>
#include <cctype>
#include <limits>
#include <set>
#include <string_view>

#include "hqslam/core/error.h"
#include "hqslam/core/excerpt.h"
#include "hqslam/core/npy.h"

namespace hqslam {

namespace {

constexpr std::string_view kMagic = "\x93NUMPY";
constexpr std::size_t kMaxHeaderBytes = 65536;
constexpr std::size_t kMaxDimensions = 32;

[[noreturn]] void fail(const std::string& path, const std::string& complaint) {
  throw Error(fmt::format("{}: {}; save the array again with numpy.save", path, complaint));
}

/// The dictionary literal of a header, read strictly: three keys in any order.
class DictionaryParser {
 public:
  DictionaryParser(std::string_view text, const std::string& path) : text_(text), path_(path) {}

  NpyHeader parse() {
    NpyHeader header;
    std::set<std::string> keys;
    expect('{');
    while (!accept('}')) {
      const std::string key = quoted();
      if (!keys.insert(key).second) complain(fmt::format("key '{}' once", excerpt(key)));
      expect(':');
      parse_value(key, header);
      if (!accept(',')) {
        expect('}');
        break;
      }
    }
    if (peek() != '\0') complain("nothing after '}'");
    if (keys.size() != 3) complain("the keys descr, fortran_order and shape");
    return header;
  }

 private:
  char peek() {
    while (position_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[position_]))) {
      ++position_;
    }
    return position_ < text_.size() ? text_[position_] : '\0';
  }

  bool accept(char c) {
    if (peek() != c) return false;
    ++position_;
    return true;
  }

  void expect(char c) {
    if (!accept(c)) complain(fmt::format("'{}'", c));
  }

  std::string quoted() {
    const char quote = peek();
    if (quote != '\'' && quote != '"') complain("a quoted word");
    const std::size_t end = text_.find(quote, position_ + 1);
    if (end == std::string_view::npos) complain("a closing quote");
    const std::string word(text_.substr(position_ + 1, end - position_ - 1));
    position_ = end + 1;
    for (const char c : word) {
      if (!std::isprint(static_cast<unsigned char>(c))) complain("printable characters in quotes");
    }
    return word;
  }

  std::int64_t integer() {
    if (!std::isdigit(static_cast<unsigned char>(peek()))) complain("a size in 'shape'");
    std::int64_t value = 0;
    while (position_ < text_.size() && std::isdigit(static_cast<unsigned char>(text_[position_]))) {
      if (value > (std::numeric_limits<std::int64_t>::max() - 9) / 10) complain("smaller sizes");
      value = value * 10 + (text_[position_++] - '0');
    }
    return value;
  }

  bool boolean() {
    peek();
    for (const bool value : {true, false}) {
      const std::string_view word = value ? "True" : "False";
      if (text_.substr(position_).starts_with(word)) {
        position_ += word.size();
        return value;
      }
    }
    complain("True or False for 'fortran_order'");
  }

  std::vector<std::int64_t> tuple() {
    std::vector<std::int64_t> shape;
    expect('(');
    while (!accept(')')) {
      if (shape.size() == kMaxDimensions) complain("at most 32 dimensions");
      shape.push_back(integer());
      if (!accept(',')) {
        expect(')');
        break;
      }
    }
    return shape;
  }

  void parse_value(const std::string& key, NpyHeader& header) {
    if (key == "descr") {
      if (peek() == '[') complain("one number per element, not an array of structures");
      header.dtype = quoted();
    } else if (key == "fortran_order") {
      header.fortran_order = boolean();
    } else if (key == "shape") {
      header.shape = tuple();
    } else {
      complain("no key but descr, fortran_order and shape");
    }
  }

  [[noreturn]] void complain(const std::string& expected) const {
    fail(path_,
         fmt::format("damaged .npy header: expected {} at its character {}", expected, position_));
  }

  std::string_view text_;
  const std::string& path_;
  std::size_t position_ = 0;
};

std::size_t size_from_little_endian(const char* bytes, std::size_t count) {
  std::size_t value = 0;
  for (std::size_t i = 0; i < count; ++i) {
    value |= static_cast<std::size_t>(static_cast<unsigned char>(bytes[i])) << (8 * i);
  }
  return value;
}

}  // namespace

NpyHeader read_npy_header(std::istream& stream, const std::string& path) {
  stream.seekg(0);
  std::array<char, 12> start{};
  stream.read(start.data(), 8);
  if (!stream || std::string_view(start.data(), kMagic.size()) != kMagic) {
    fail(path, "expected an .npy file (it begins with \\x93NUMPY), found something else");
  }
  const int version = static_cast<unsigned char>(start[6]);
  if (version < 1 || version > 3 || start[7] != 0) {
    fail(path, fmt::format("expected .npy version 1.0, 2.0 or 3.0, found {}.{}", version,
                           static_cast<unsigned char>(start[7])));
  }
  const std::size_t size_bytes = version == 1 ? 2 : 4;
  stream.read(start.data() + 8, static_cast<std::streamsize>(size_bytes));
  const std::size_t length = size_from_little_endian(start.data() + 8, size_bytes);
  if (!stream || length > kMaxHeaderBytes) {
    fail(path, fmt::format("expected an .npy header of at most {} bytes, found {}", kMaxHeaderBytes,
                           stream ? fmt::format("{} bytes", length) : "the end of the file"));
  }
  std::string text(length, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(length));
  if (!stream) {
    fail(path, fmt::format("truncated: expected an .npy header of {} bytes, found {} bytes", length,
                           stream.gcount()));
  }
  NpyHeader header = DictionaryParser(text, path).parse();
  header.data_offset_bytes = static_cast<std::int64_t>(8 + size_bytes + length);
  return header;
}

}  // namespace hqslam

#include "pcd_columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <limits>
#include <optional>

#include "hqslam/core/error.h"
#include "hqslam/core/excerpt.h"
#include "lzf.h"
#include "stored_number.h"

namespace hqslam {

static_assert(std::endian::native == std::endian::little, "files are little-endian, and so are we");

namespace {

/// As much as the most points that a header may announce take with 32 bytes each.
constexpr std::size_t kMaxDecompressedBytes = std::size_t{1} << 30U;

/// Whether a number that no double holds is too large rather than too small: the decimal place of
/// its first digit that is not 0, moved by its exponent, is left of the point.
bool is_too_large(std::string_view word) {
  const std::size_t e = std::min(word.find_first_of("eE"), word.size());
  std::int64_t exponent = 0;
  if (e < word.size()) {
    const std::string_view text = word.substr(word[e + 1] == '+' ? e + 2 : e + 1);
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), exponent);
    if (error == std::errc::result_out_of_range) return text[0] != '-';
  }
  const std::string_view mantissa = word.substr(0, e);
  const std::size_t point = std::min(mantissa.find('.'), mantissa.size());
  const auto first = mantissa.find_first_of("123456789");
  if (first == std::string_view::npos) return false;
  return exponent > static_cast<std::int64_t>(first) - static_cast<std::int64_t>(point);
}

/// A number as text, infinite where it is too large for a double, 0 where it is too small; nothing
/// if the word is no number.
std::optional<double> number_in(std::string_view word) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc::invalid_argument || end != word.data() + word.size()) return std::nullopt;
  if (error == std::errc()) return value;
  if (!is_too_large(word)) return 0.0;
  return word[0] == '-' ? -std::numeric_limits<double>::infinity()
                        : std::numeric_limits<double>::infinity();
}

}  // namespace

double PcdColumn::at(std::size_t point) const {
  return number_at(first + point * stride_bytes, {type, size_bytes});
}

PcdColumns::PcdColumns(std::string_view file, const PcdHeader& header, const std::string& path)
    : header_(header), path_(path) {
  const std::string_view data = file.substr(header.data_offset_bytes);
  if (header.data == PcdData::kAscii) check_ascii(data);
  if (header.data == PcdData::kBinary) read_binary(data);
  if (header.data == PcdData::kBinaryCompressed) read_compressed(data);
}

PcdColumn PcdColumns::column(const PcdField& field) const {
  if (field.count == 0) {
    throw Error(
        fmt::format("{}: field '{}': expected one number per point, found none; give a "
                    ".pcd file with COUNT 1 for it",
                    path_, excerpt(field.name)));
  }
  if (header_.data == PcdData::kAscii) {
    return {reinterpret_cast<const char*>(numbers_.data() + field.first_number), 0, 'F',
            sizeof(double)};
  }
  if (header_.data == PcdData::kBinary) {
    return {points_ + field.offset_bytes, header_.point_bytes, field.type, field.size_bytes};
  }
  return {decompressed_.data() + header_.points * field.offset_bytes,
          field.size_bytes * field.count, field.type, field.size_bytes};
}

void PcdColumns::check_ascii(std::string_view data) {
  const std::size_t expected = header_.points * header_.point_numbers;
  // Each number takes a character and a separator.
  if (header_.points > data.size() || expected > (data.size() + 1) / 2) {
    throw Error(
        fmt::format("{}: truncated: expected {} points of {} numbers, found {} bytes; copy "
                    "the file again",
                    path_, header_.points, header_.point_numbers, data.size()));
  }
  rest_ = data;
  numbers_.resize(header_.point_numbers);
}

void PcdColumns::read_point(std::size_t point) {
  if (header_.data != PcdData::kAscii) return;
  constexpr std::string_view kSpace = " \t\r\n";
  for (std::size_t i = 0; i < numbers_.size(); ++i) {
    rest_.remove_prefix(std::min(rest_.find_first_not_of(kSpace), rest_.size()));
    if (rest_.empty()) {
      throw Error(
          fmt::format("{}: truncated: expected {} points of {} numbers, found {} numbers; "
                      "copy the file again",
                      path_, header_.points, numbers_.size(), point * numbers_.size() + i));
    }
    const std::string_view word = rest_.substr(0, rest_.find_first_of(kSpace));
    const std::optional<double> value = number_in(word);
    if (!value) {
      throw Error(fmt::format("{}: point {}: expected a number, found '{}'; correct the line",
                              path_, point, excerpt(word)));
    }
    numbers_[i] = *value;
    rest_.remove_prefix(word.size());
  }
}

void PcdColumns::read_binary(std::string_view data) {
  const bool fits = header_.point_bytes == 0 || header_.points <= data.size() / header_.point_bytes;
  if (!fits) {
    throw Error(
        fmt::format("{}: truncated: expected {} points of {} bytes, found {} bytes; copy "
                    "the file again",
                    path_, header_.points, header_.point_bytes, data.size()));
  }
  points_ = data.data();
}

void PcdColumns::read_compressed(std::string_view data) {
  std::uint32_t compressed_bytes = 0;
  std::uint32_t bytes = 0;
  constexpr std::size_t kSizes = sizeof(compressed_bytes) + sizeof(bytes);
  if (data.size() >= kSizes) {
    std::memcpy(&compressed_bytes, data.data(), sizeof(compressed_bytes));
    std::memcpy(&bytes, data.data() + sizeof(compressed_bytes), sizeof(bytes));
  }
  if (data.size() < kSizes || compressed_bytes > data.size() - kSizes) {
    throw Error(
        fmt::format("{}: truncated: expected {} compressed bytes, found {}; copy the file "
                    "again",
                    path_, compressed_bytes, data.size() < kSizes ? 0 : data.size() - kSizes));
  }
  const bool fits = header_.point_bytes == 0 || (bytes % header_.point_bytes == 0 &&
                                                 bytes / header_.point_bytes == header_.points);
  if (!fits) {
    throw Error(
        fmt::format("{}: expected {} points of {} bytes, found {} bytes when decompressed; "
                    "write the file again",
                    path_, header_.points, header_.point_bytes, bytes));
  }
  if (bytes > kMaxDecompressedBytes) {
    throw Error(
        fmt::format("{}: expected at most {} bytes when decompressed, found {}; leave out fields "
                    "other than x y z",
                    path_, kMaxDecompressedBytes, bytes));
  }
  auto decompressed = lzf_decompressed(data.substr(kSizes, compressed_bytes), bytes);
  if (!decompressed) {
    throw Error(
        fmt::format("{}: expected LZF data that stand for {} bytes, found damaged data; "
                    "copy the file again",
                    path_, bytes));
  }
  decompressed_ = std::move(*decompressed);
}

}  // namespace hqslam

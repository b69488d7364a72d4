#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <sstream>
#include <utility>

#include "hqslam/core/error.h"
#include "hqslam/core/excerpt.h"
#include "hqslam/core/npy.h"
#include "hqslam/core/npz.h"
#include "npy_header_bytes.h"
#include "npz_layout.h"
#include "npz_zip.h"

namespace hqslam {

namespace {

/// The longest header that read_npy_header accepts, with what comes before it.
constexpr std::int64_t kMaxHeaderBytes = 65536 + 12;

std::int64_t length_of(const std::string& path) {
  std::error_code error;
  const bool regular = std::filesystem::is_regular_file(path, error);
  const auto length = regular ? std::filesystem::file_size(path, error) : 0;
  if (!regular || error) {
    throw Error(fmt::format("{}: expected an .npz file, found {}; check the path", path,
                            std::filesystem::is_directory(path, error) ? "a folder" : "no file"));
  }
  return static_cast<std::int64_t>(length);
}

/// `where` begins the messages; see read_npz for `largest_bytes`.
void require_size(const std::string& where, std::int64_t found_bytes, std::int64_t largest_bytes) {
  if (found_bytes <= largest_bytes) return;
  throw Error(
      fmt::format("{}: too large: expected at most {} bytes, found {}; check that this is "
                  "the right file",
                  where, largest_bytes, found_bytes));
}

ZipArchive opened(const std::string& path, std::int64_t file_bytes) {
  int code = ZIP_ER_NOZIP;  // libzip would take an empty file for an empty archive
  ZipArchive archive(file_bytes > 0 ? zip_open(path.c_str(), ZIP_RDONLY, &code) : nullptr);
  if (!archive) {
    fail_npz(path, "an .npz file (a zip archive)",
             fmt::format("another or a part of one ({})", zip_error_text(code)));
  }
  return archive;
}

/// The array of a member but for its bytes, and how many these are.
std::pair<NpzArray, std::int64_t> announced(const NpyHeader& header, const ZipMember& member) {
  NpzArray array;
  array.dtype = header.dtype;
  array.shape = header.shape;
  const auto element_bytes = npz_element_bytes(header.dtype);
  if (!element_bytes) {
    fail_npz(member.where, fmt::format("dtype {}", kNpzDtypes),
             fmt::format("'{}'", excerpt(header.dtype)));
  }
  if (header.fortran_order) {
    fail_npz(member.where, "C order (numpy.ascontiguousarray)", "Fortran order");
  }
  const std::int64_t found = member.bytes - header.data_offset_bytes;
  const auto count = npz_element_count(header.shape);
  if (!count || *count * *element_bytes != found) {
    fail_npz(member.where,
             fmt::format("the bytes of shape {} and dtype '{}'", npy_shape_text(header.shape),
                         header.dtype),
             fmt::format("{} bytes", found));
  }
  return {std::move(array), found};
}

NpzArray read_member(zip_t* archive, const ZipMember& member, std::int64_t largest_bytes) {
  ZipMemberStream stream(archive, member);
  std::string start(static_cast<std::size_t>(std::min(member.bytes, kMaxHeaderBytes)), '\0');
  stream.read(start.data(), static_cast<std::int64_t>(start.size()));
  std::istringstream header_stream(start);
  const NpyHeader header = read_npy_header(header_stream, member.where);
  auto [array, bytes] = announced(header, member);
  require_size(member.where, bytes, largest_bytes);
  array.bytes.resize(static_cast<std::size_t>(bytes));
  const auto begin = start.begin() + header.data_offset_bytes;
  std::transform(begin, start.end(), array.bytes.begin(),
                 [](char c) { return static_cast<std::byte>(c); });
  const std::int64_t done = start.end() - begin;
  stream.read(array.bytes.data() + done, bytes - done);
  stream.require_end();
  return std::move(array);
}

}  // namespace

NpzArrays read_npz(const std::string& path, std::int64_t largest_bytes) {
  // What zip and the .npy headers add to the arrays.
  constexpr std::int64_t kMaxOverheadBytes = 64LL << 20;
  const std::int64_t file_bytes = length_of(path);
  require_size(path, file_bytes - kMaxOverheadBytes, largest_bytes);
  const ZipArchive archive = opened(path, file_bytes);
  NpzArrays arrays;
  std::int64_t left_bytes = largest_bytes;
  for (const ZipMember& member : npz_members(archive.get(), path, file_bytes)) {
    NpzArray array = read_member(archive.get(), member, left_bytes);
    left_bytes -= static_cast<std::int64_t>(array.bytes.size());
    arrays.emplace(member.name, std::move(array));
  }
  return arrays;
}

}  // namespace hqslam

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <memory>
#include <set>
#include <sstream>
#include <string_view>
#include <utility>

#include "files/npy_format.h"
#include "files/zip_archive.h"
#include "hqslam/core/error.h"
#include "hqslam/core/excerpt.h"
#include "hqslam/core/npy.h"
#include "hqslam/core/npz.h"

namespace hqslam {

namespace {

constexpr std::string_view kEnding = ".npy";

/// The longest header that read_npy_header accepts, with what comes before it.
constexpr std::int64_t kMaxArrayHeaderBytes = 65536 + 12;

/// Throws the Error about a damaged or foreign .npz file: "where: expected .., found ..".
[[noreturn]] void fail_in_npz(const std::string& where, const std::string& expected,
                              const std::string& found) {
  throw Error("{}: expected {}, found {}; copy the file or save it again with numpy.savez", where,
              expected, found);
}

/// A member as the archive's directory describes it.
struct ZipMember {
  std::string name;   ///< without ".npy"
  std::string where;  ///< file and member, the beginning of every message about it
  zip_uint64_t index = 0;
  std::int64_t bytes = 0;  ///< as claimed, but no more than the packed bytes could yield
};

zip_stat_t directory_entry(zip_t* archive, zip_uint64_t index, const std::string& path) {
  constexpr zip_uint64_t kNeeded = ZIP_STAT_NAME | ZIP_STAT_SIZE | ZIP_STAT_COMP_SIZE |
                                   ZIP_STAT_COMP_METHOD | ZIP_STAT_ENCRYPTION_METHOD;
  zip_stat_t entry;
  zip_stat_init(&entry);
  const bool known = zip_stat_index(archive, index, ZIP_FL_ENC_RAW, &entry) == 0;
  if (!known || (entry.valid & kNeeded) != kNeeded) {
    fail_in_npz(path, fmt::format("name, size and method of member {}", index),
                known ? "a part of them" : zip_strerror(archive));
  }
  return entry;
}

/// Refuses a claim of more bytes than the packed ones can yield.
void require_possible_size(const zip_stat_t& entry, const std::string& where) {
  // Deflate's best is 258 bytes from two bits. Source: RFC 1951.
  const zip_uint64_t ratio = entry.comp_method == ZIP_CM_DEFLATE ? 1032 : 1;
  constexpr zip_uint64_t kMax = std::numeric_limits<std::int64_t>::max();
  if (entry.size > kMax || entry.size / ratio > entry.comp_size) {
    fail_in_npz(where, fmt::format("at most {} bytes from each of {}", ratio, entry.comp_size),
                fmt::format("a claim of {} bytes", entry.size));
  }
}

ZipMember npz_member(const zip_stat_t& entry, const std::string& path) {
  const std::string_view name = entry.name;
  ZipMember member;
  member.where = fmt::format("{}: member '{}'", path, excerpt(name, kNameCharacters));
  if (!name.ends_with(kEnding) || name.size() == kEnding.size()) {
    fail_in_npz(member.where, "a name that ends in .npy", "another");
  }
  if (entry.encryption_method != ZIP_EM_NONE) {
    fail_in_npz(member.where, "no encryption", fmt::format("method {}", entry.encryption_method));
  }
  if (entry.comp_method != ZIP_CM_STORE && entry.comp_method != ZIP_CM_DEFLATE) {
    fail_in_npz(member.where, "a stored or deflated member",
                fmt::format("compression method {}", entry.comp_method));
  }
  require_possible_size(entry, member.where);
  member.name = name.substr(0, name.size() - kEnding.size());
  member.index = entry.index;
  member.bytes = static_cast<std::int64_t>(entry.size);
  return member;
}

/// The members in the order of the archive. Throws Error unless all are .npy files of different
/// names, not encrypted, stored or deflated, and together no longer than `file_bytes`.
std::vector<ZipMember> npz_members(zip_t* archive, const std::string& path,
                                   std::int64_t file_bytes) {
  std::vector<ZipMember> members;
  std::set<std::string> names;
  // Members that share their packed bytes could make a small file a long work.
  auto left = static_cast<zip_uint64_t>(file_bytes);
  const zip_int64_t count = zip_get_num_entries(archive, 0);
  for (zip_int64_t index = 0; index < count; ++index) {
    const zip_stat_t entry = directory_entry(archive, static_cast<zip_uint64_t>(index), path);
    members.push_back(npz_member(entry, path));
    const ZipMember& member = members.back();
    if (!names.insert(member.name).second) fail_in_npz(member.where, "every name once", "it twice");
    if (entry.comp_size > left) {
      fail_in_npz(member.where,
                  fmt::format("at most {} packed bytes in the rest of the file", left),
                  fmt::format("{}", entry.comp_size));
    }
    left -= entry.comp_size;
  }
  return members;
}

/// The unpacked bytes of a member from its beginning. Throws Error.
class ZipMemberStream {
 public:
  ZipMemberStream(zip_t* archive, const ZipMember& member)
      : where_(member.where),
        bytes_(member.bytes),
        file_(zip_fopen_index(archive, member.index, 0)) {
    if (!file_) fail_in_npz(where_, "a member that can be opened", zip_strerror(archive));
  }

  /// Reads exactly `count` bytes.
  void read(void* bytes, std::int64_t count) {
    std::int64_t done = 0;
    while (done < count) {
      const zip_int64_t found = zip_fread(file_.get(), static_cast<std::byte*>(bytes) + done,
                                          static_cast<zip_uint64_t>(count - done));
      if (found < 0) {
        fail_in_npz(where_, fmt::format("{} bytes that can be unpacked", bytes_),
                    fmt::format("damage after {} ({})", position_, zip_file_strerror(file_.get())));
      }
      if (found == 0)
        fail_in_npz(where_, fmt::format("{} bytes", bytes_), fmt::format("{}", position_));
      done += found;
      position_ += found;
    }
  }

  /// Throws unless the member ends here and its checksum is right.
  void require_end() {
    // libzip compares size and checksum when it reaches the end.
    std::byte beyond{};
    const zip_int64_t found = zip_fread(file_.get(), &beyond, 1);
    if (found < 0) {
      fail_in_npz(where_, fmt::format("{} bytes with the right checksum", bytes_),
                  zip_file_strerror(file_.get()));
    }
    if (found > 0) fail_in_npz(where_, fmt::format("{} bytes", bytes_), "more");
  }

 private:
  std::string where_;
  std::int64_t bytes_;
  std::int64_t position_ = 0;
  std::unique_ptr<zip_file_t, decltype([](zip_file_t* file) { zip_fclose(file); })> file_;
};

std::int64_t length_of(const std::string& path) {
  std::error_code error;
  const bool regular = std::filesystem::is_regular_file(path, error);
  const auto length = regular ? std::filesystem::file_size(path, error) : 0;
  if (!regular || error) {
    throw Error("{}: expected an .npz file, found {}; check the path", path,
                std::filesystem::is_directory(path, error) ? "a folder" : "no file");
  }
  return static_cast<std::int64_t>(length);
}

/// `where` begins the messages; see read_npz for `largest_bytes`.
void require_size(const std::string& where, std::int64_t found_bytes, std::int64_t largest_bytes) {
  if (found_bytes <= largest_bytes) return;
  throw Error(
      "{}: too large: expected at most {} bytes, found {}; check that this is the right file",
      where, largest_bytes, found_bytes);
}

/// libzip's text of one of its error codes.
std::string zip_error_text(int code) {
  zip_error_t error;
  zip_error_init_with_code(&error, code);
  const std::string text = zip_error_strerror(&error);
  zip_error_fini(&error);
  return text;
}

ZipArchive opened(const std::string& path, std::int64_t file_bytes) {
  int code = ZIP_ER_NOZIP;  // libzip would take an empty file for an empty archive
  ZipArchive archive(file_bytes > 0 ? zip_open(path.c_str(), ZIP_RDONLY, &code) : nullptr);
  if (!archive) {
    fail_in_npz(path, "an .npz file (a zip archive)",
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
    fail_in_npz(member.where, fmt::format("dtype {}", kNpzDtypes),
                fmt::format("'{}'", excerpt(header.dtype)));
  }
  if (header.fortran_order) {
    fail_in_npz(member.where, "C order (numpy.ascontiguousarray)", "Fortran order");
  }
  const std::int64_t found = member.bytes - header.data_offset_bytes;
  const auto count = npz_element_count(header.shape);
  if (!count || *count * *element_bytes != found) {
    fail_in_npz(member.where,
                fmt::format("the bytes of shape {} and dtype '{}'", npy_shape_text(header.shape),
                            header.dtype),
                fmt::format("{} bytes", found));
  }
  return {std::move(array), found};
}

NpzArray read_member(zip_t* archive, const ZipMember& member, std::int64_t largest_bytes) {
  ZipMemberStream stream(archive, member);
  std::string start(static_cast<std::size_t>(std::min(member.bytes, kMaxArrayHeaderBytes)), '\0');
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

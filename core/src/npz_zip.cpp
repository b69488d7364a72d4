#include "npz_zip.h"

#include <fmt/format.h>

#include <limits>
#include <set>
#include <string_view>

#include "hqslam/core/error.h"
#include "hqslam/core/excerpt.h"

namespace hqslam {

namespace {

/// More than the longest name of a network's weight.
constexpr std::size_t kNameCharacters = 120;
constexpr std::string_view kEnding = ".npy";

zip_stat_t directory_entry(zip_t* archive, zip_uint64_t index, const std::string& path) {
  constexpr zip_uint64_t kNeeded = ZIP_STAT_NAME | ZIP_STAT_SIZE | ZIP_STAT_COMP_SIZE |
                                   ZIP_STAT_COMP_METHOD | ZIP_STAT_ENCRYPTION_METHOD;
  zip_stat_t entry;
  zip_stat_init(&entry);
  const bool known = zip_stat_index(archive, index, ZIP_FL_ENC_RAW, &entry) == 0;
  if (!known || (entry.valid & kNeeded) != kNeeded) {
    fail_npz(path, fmt::format("name, size and method of member {}", index),
             known ? "a part of them" : zip_strerror(archive));
  }
  return entry;
}

/// A claim of more bytes than the packed ones can yield must not be believed.
void require_possible_size(const zip_stat_t& entry, const std::string& where) {
  // Deflate's best is 258 bytes from two bits. Source: RFC 1951.
  const zip_uint64_t ratio = entry.comp_method == ZIP_CM_DEFLATE ? 1032 : 1;
  constexpr zip_uint64_t kMax = std::numeric_limits<std::int64_t>::max();
  if (entry.size > kMax || entry.size / ratio > entry.comp_size) {
    fail_npz(where, fmt::format("at most {} bytes from each of {}", ratio, entry.comp_size),
             fmt::format("a claim of {} bytes", entry.size));
  }
}

ZipMember npz_member(const zip_stat_t& entry, const std::string& path) {
  const std::string_view name = entry.name;
  ZipMember member;
  member.where = fmt::format("{}: member '{}'", path, excerpt(name, kNameCharacters));
  if (!name.ends_with(kEnding) || name.size() == kEnding.size()) {
    fail_npz(member.where, "a name that ends in .npy", "another");
  }
  if (entry.encryption_method != ZIP_EM_NONE) {
    fail_npz(member.where, "no encryption", fmt::format("method {}", entry.encryption_method));
  }
  if (entry.comp_method != ZIP_CM_STORE && entry.comp_method != ZIP_CM_DEFLATE) {
    fail_npz(member.where, "a stored or deflated member",
             fmt::format("compression method {}", entry.comp_method));
  }
  require_possible_size(entry, member.where);
  member.name = name.substr(0, name.size() - kEnding.size());
  member.index = entry.index;
  member.bytes = static_cast<std::int64_t>(entry.size);
  return member;
}

}  // namespace

void fail_npz(const std::string& where, const std::string& expected, const std::string& found) {
  throw Error(
      fmt::format("{}: expected {}, found {}; copy the file or save it again with "
                  "numpy.savez",
                  where, expected, found));
}

std::string zip_error_text(int code) {
  zip_error_t error;
  zip_error_init_with_code(&error, code);
  const std::string text = zip_error_strerror(&error);
  zip_error_fini(&error);
  return text;
}

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
    if (!names.insert(member.name).second) fail_npz(member.where, "every name once", "it twice");
    if (entry.comp_size > left) {
      fail_npz(member.where, fmt::format("at most {} packed bytes in the rest of the file", left),
               fmt::format("{}", entry.comp_size));
    }
    left -= entry.comp_size;
  }
  return members;
}

ZipMemberStream::ZipMemberStream(zip_t* archive, const ZipMember& member)
    : where_(member.where), bytes_(member.bytes), file_(zip_fopen_index(archive, member.index, 0)) {
  if (!file_) fail_npz(where_, "a member that can be opened", zip_strerror(archive));
}

void ZipMemberStream::read(void* bytes, std::int64_t count) {
  std::int64_t done = 0;
  while (done < count) {
    const zip_int64_t found = zip_fread(file_.get(), static_cast<std::byte*>(bytes) + done,
                                        static_cast<zip_uint64_t>(count - done));
    if (found < 0) {
      fail_npz(where_, fmt::format("{} bytes that can be unpacked", bytes_),
               fmt::format("damage after {} ({})", position_, zip_file_strerror(file_.get())));
    }
    if (found == 0) fail_npz(where_, fmt::format("{} bytes", bytes_), fmt::format("{}", position_));
    done += found;
    position_ += found;
  }
}

void ZipMemberStream::require_end() {
  // libzip compares size and checksum when it reaches the end.
  std::byte beyond{};
  const zip_int64_t found = zip_fread(file_.get(), &beyond, 1);
  if (found < 0) {
    fail_npz(where_, fmt::format("{} bytes with the right checksum", bytes_),
             zip_file_strerror(file_.get()));
  }
  if (found > 0) fail_npz(where_, fmt::format("{} bytes", bytes_), "more");
}

}  // namespace hqslam

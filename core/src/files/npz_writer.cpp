#include <fmt/format.h>

#include <map>
#include <memory>
#include <string>
#include <string_view>

#include "files/npy_format.h"
#include "files/zip_archive.h"
#include "hqslam/core/error.h"
#include "hqslam/core/excerpt.h"
#include "hqslam/core/npz.h"
#include "hqslam/core/whole_file.h"

namespace hqslam {

namespace {

[[noreturn]] void fail_to_write(const std::string& path, const std::string& reason) {
  throw Error(
      "{}: cannot be written ({}); check that the folder exists, is writable and has free space",
      path, reason);
}

using ZipSource =
    std::unique_ptr<zip_source_t, decltype([](zip_source_t* source) { zip_source_free(source); })>;

/// An archive that is kept in memory: of one that is kept in a file libzip would leave its own
/// temporary file behind if the program were killed. `source` stays the caller's.
ZipArchive created(zip_source_t* source, const std::string& path) {
  zip_error_t error;
  zip_error_init(&error);
  ZipArchive archive(zip_open_from_source(source, ZIP_TRUNCATE, &error));
  if (!archive) fail_to_write(path, zip_error_strerror(&error));
  zip_source_keep(source);
  return archive;
}

std::string bytes_of(zip_source_t* source, const std::string& path) {
  zip_stat_t stat;
  zip_stat_init(&stat);
  bool good = zip_source_open(source) == 0 && zip_source_stat(source, &stat) == 0;
  std::string bytes(good ? stat.size : 0, '\0');
  good = good && zip_source_read(source, bytes.data(), bytes.size()) ==
                     static_cast<zip_int64_t>(bytes.size());
  if (!good) fail_to_write(path, zip_error_strerror(zip_source_error(source)));
  zip_source_close(source);
  return bytes;
}

/// The bytes of an array's .npy file.
std::string npy_file(const std::string& path, const std::string& name, const NpzArray& array) {
  const std::string where = fmt::format("{}: array '{}'", path, excerpt(name, kNameCharacters));
  constexpr std::size_t kMostDimensions = 32;  // numpy's limit
  const auto size = npz_element_bytes(array.dtype);
  if (!size) {
    throw Error("{}: expected dtype {}, found '{}'", where, kNpzDtypes, array.dtype);
  }
  const auto count = npz_element_count(array.shape);
  if (!count || array.shape.size() > kMostDimensions ||
      static_cast<std::size_t>(*count * *size) != array.bytes.size()) {
    throw Error("{}: expected the bytes of shape {} and dtype '{}', found {} bytes", where,
                npy_shape_text(array.shape), array.dtype, array.bytes.size());
  }
  std::string file = npy_header_bytes(array.dtype, array.shape, 0);
  file.append(reinterpret_cast<const char*>(array.bytes.data()), array.bytes.size());
  return file;
}

void require_name(const std::string& path, const std::string& name) {
  // libzip would write a longer name with a wrong length.
  constexpr std::size_t kMaxNameBytes = 65535 - std::string_view(".npy").size();
  if (!name.empty() && name.size() <= kMaxNameBytes && name.find('\0') == std::string::npos) return;
  throw Error(
      "{}: expected array names of 1 to {} bytes without a zero byte, found '{}' of {} bytes", path,
      kMaxNameBytes, excerpt(name, kNameCharacters), name.size());
}

/// `file` must live until the archive is closed.
void add_member(zip_t* archive, const std::string& path, const std::string& name,
                const std::string& file) {
  // Midnight of 1980-01-01, zip's earliest, as stored: a time_t would pass through the time zone.
  constexpr zip_uint16_t kTime = 0;
  constexpr zip_uint16_t kDate = (1 << 5) | 1;
  constexpr zip_uint32_t kDefaultLevel = 0;
  zip_source_t* source = zip_source_buffer(archive, file.data(), file.size(), 0);
  if (source == nullptr) fail_to_write(path, zip_strerror(archive));
  const zip_int64_t index =
      zip_file_add(archive, (name + ".npy").c_str(), source, ZIP_FL_ENC_UTF_8);
  if (index < 0) {
    const std::string reason = zip_strerror(archive);
    zip_source_free(source);
    throw Error("{}: expected array names in UTF-8, found '{}' ({})", path,
                excerpt(name, kNameCharacters), reason);
  }
  const auto member = static_cast<zip_uint64_t>(index);
  if (zip_set_file_compression(archive, member, ZIP_CM_DEFLATE, kDefaultLevel) != 0 ||
      zip_file_set_dostime(archive, member, kTime, kDate, 0) != 0) {
    fail_to_write(path, zip_strerror(archive));
  }
}

}  // namespace

void write_npz(const std::string& path, const NpzArrays& arrays) {
  if (arrays.empty()) {
    throw Error("{}: expected at least one array to write, found none", path);
  }
  std::map<std::string, std::string> files;
  for (const auto& [name, array] : arrays) {
    require_name(path, name);
    files[name] = npy_file(path, name, array);
  }
  const ZipSource source(zip_source_buffer_create(nullptr, 0, 0, nullptr));
  if (!source) fail_to_write(path, "no memory");
  ZipArchive archive = created(source.get(), path);
  for (const auto& [name, file] : files) add_member(archive.get(), path, name, file);
  if (zip_close(archive.get()) != 0) fail_to_write(path, zip_strerror(archive.get()));
  (void)archive.release();
  const std::string bytes = bytes_of(source.get(), path);
  replace_file(path, [&](const std::string& part) { write_whole_file(part, bytes); });
}

}  // namespace hqslam

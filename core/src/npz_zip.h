#pragma once

#include <zip.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace hqslam {

/// The one complaint about a damaged or foreign .npz file: "where: expected .., found ..".
[[noreturn]] void fail_npz(const std::string& where, const std::string& expected,
                           const std::string& found);

struct DiscardZip {
  void operator()(zip_t* archive) const { zip_discard(archive); }
};
using ZipArchive = std::unique_ptr<zip_t, DiscardZip>;

/// What libzip has to say about one of its error codes.
std::string zip_error_text(int code);

/// A member as the archive's directory describes it.
struct ZipMember {
  std::string name;   ///< without ".npy"
  std::string where;  ///< file and member, the beginning of every message about it
  zip_uint64_t index = 0;
  std::int64_t bytes = 0;  ///< as claimed, but no more than the packed bytes could yield
};

/// The members in the order of the archive. Throws Error unless all are .npy files of different
/// names, not encrypted, stored or deflated, and together no longer than `file_bytes`.
std::vector<ZipMember> npz_members(zip_t* archive, const std::string& path,
                                   std::int64_t file_bytes);

/// The unpacked bytes of a member from its beginning. Throws Error.
class ZipMemberStream {
 public:
  ZipMemberStream(zip_t* archive, const ZipMember& member);
  /// Exactly so many bytes.
  void read(void* bytes, std::int64_t count);
  /// Throws unless the member ends here and its checksum is right.
  void require_end();

 private:
  struct Close {
    void operator()(zip_file_t* file) const { zip_fclose(file); }
  };
  std::string where_;
  std::int64_t bytes_;
  std::int64_t position_ = 0;
  std::unique_ptr<zip_file_t, Close> file_;
};

}  // namespace hqslam

#pragma once

#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bag.h"
#include "byte_reader.h"

namespace hqslam::recordings {

/// A message of some connection of a bag that is read from its beginning to its end.
struct ConnectionMessage {
  std::uint32_t connection = 0;
  Message message;
};

/// Which topic a connection is of.
struct Connection {
  std::string topic;
  std::string type;
};

/// A bag's file, message by message.
class BagFile {
 public:
  virtual ~BagFile() = default;
  /// The next message of a known connection; nothing at the end, be it that of the file or of what
  /// was written of it. Throws Error for a damaged file.
  virtual std::optional<ConnectionMessage> next() = 0;
  /// The connections that were met so far.
  virtual const std::map<std::uint32_t, Connection>& connections() const = 0;
};

using OpenBagFile = std::unique_ptr<BagFile> (*)(const std::string& path);

/// A bag that keeps no table of its messages: it is read once to list and count them.
std::unique_ptr<Bag> scanned_bag(const std::string& path, const std::string& kind,
                                 OpenBagFile open);

/// The bytes of a file that follow one another; nothing is read of what a damaged length claims
/// beyond the file's end.
class FileBytes {
 public:
  explicit FileBytes(const std::string& path);
  /// The next `count` bytes; false at the end. They live until the next call.
  bool read(std::uint64_t count, Bytes& bytes);
  bool skip(std::uint64_t count);
  std::uint64_t left() const { return size_ - at_; }

 private:
  std::ifstream stream_;
  std::uint64_t size_ = 0;
  std::uint64_t at_ = 0;
  std::vector<std::uint8_t> buffer_;
};

}  // namespace hqslam::recordings

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

/// A bag's file, record by record; records may be packed in chunks.
class BagFile {
 public:
  /// Begins behind the file's first bytes; `repair` ends the messages about damage.
  BagFile(const std::string& path, std::uint64_t first_bytes, std::string repair);
  virtual ~BagFile() = default;
  /// The next message of a known connection; nothing at the end, be it that of the file or of what
  /// was written of it. Throws Error for a damaged file.
  std::optional<ConnectionMessage> next();
  /// The connections that were met so far.
  const std::map<std::uint32_t, Connection>& connections() const { return connections_; }

 protected:
  /// Sets `message` if the record is one; false at the end. Throws Error, with no file's name in
  /// it.
  virtual bool read_record(std::optional<ConnectionMessage>& message) = 0;

  /// The next bytes of the chunk that is open, else of the file; false at the file's end, and
  /// nothing is read of what a damaged length claims beyond it. They live until the next call,
  /// those of a chunk until the next chunk.
  bool read(std::uint64_t count, Bytes& bytes);
  bool skip(std::uint64_t count);
  /// What comes next is the records in these bytes. A chunk in a chunk is passed over.
  void open_chunk(Bytes packed, const std::string& compression, std::uint64_t size);
  void add_connection(std::uint32_t id, Connection connection);

 private:
  std::string path_;
  std::string repair_;
  std::ifstream stream_;
  std::uint64_t left_ = 0;  ///< of the file, bytes
  std::vector<std::uint8_t> buffer_;
  std::vector<std::uint8_t> chunk_;
  Bytes left_of_chunk_;
  bool in_chunk_ = false;
  std::map<std::uint32_t, Connection> connections_;
};

using OpenBagFile = std::unique_ptr<BagFile> (*)(const std::string& path);

/// A bag that keeps no table of its messages: it is read once to list and count them.
std::unique_ptr<Bag> scanned_bag(const std::string& path, const std::string& kind,
                                 OpenBagFile open);

}  // namespace hqslam::recordings

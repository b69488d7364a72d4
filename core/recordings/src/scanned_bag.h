#pragma once

#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "bag.h"
#include "byte_reader.h"

namespace hqslam::recordings {

/// A bag's file, record by record; records may be packed in chunks.
class ScannedBag : public BagFile {
 public:
  /// Begins behind the file's first bytes; `repair` ends the messages about damage.
  ScannedBag(const std::string& path, std::uint64_t first_bytes, std::string repair);
  std::optional<Message> next() override;
  double read_share() const override;

 protected:
  /// Sets `message` if the record is one; false at the end. Throws Error, with no file's name in
  /// it.
  virtual bool read_record(std::optional<Message>& message) = 0;

  /// The next bytes of the chunk that is open, else of the file; false at the file's end, and
  /// nothing is read of what a damaged length claims beyond it. They live until the next call,
  /// those of a chunk until the next chunk.
  bool read(std::uint64_t count, Bytes& bytes);
  bool skip(std::uint64_t count);
  /// What comes next is the records in these bytes. A chunk in a chunk is passed over.
  void open_chunk(Bytes packed, const std::string& compression, std::uint64_t size);
  void add_topic(std::uint32_t id, Topic topic);

 private:
  std::string path_;
  std::string repair_;
  std::ifstream stream_;
  std::uint64_t bytes_ = 0;  ///< of the file
  std::uint64_t left_ = 0;   ///< of these
  std::vector<std::uint8_t> buffer_;
  std::vector<std::uint8_t> chunk_;
  Bytes left_of_chunk_;
  bool in_chunk_ = false;
};

}  // namespace hqslam::recordings

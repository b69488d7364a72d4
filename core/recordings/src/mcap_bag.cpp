#include <fmt/format.h>

#include "decompress.h"
#include "hqslam/core/error.h"
#include "scanned_bag.h"

namespace hqslam::recordings {

namespace {

constexpr std::uint64_t kMagicBytes = 8;
constexpr std::uint64_t kRecordHeader = 9;  // opcode and length
constexpr std::size_t kMaxConnections = 65536;
enum Opcode : std::uint8_t { kSchema = 3, kChannel = 4, kMessage = 5, kChunk = 6 };

/// The fields of a record, one after the other. Throws Error at its end.
class Fields {
 public:
  explicit Fields(Bytes record) : bytes_(record) {}

  template <typename T>
  T number() {
    return little_endian<T>(take(sizeof(T)).data());
  }
  std::string words() {
    const Bytes characters = take(number<std::uint32_t>());
    return {characters.begin(), characters.end()};
  }
  Bytes take(std::uint64_t count) {
    if (count > bytes_.size()) {
      throw Error(
          fmt::format("expected {} more bytes of a record, found {}", count, bytes_.size()));
    }
    const Bytes result = bytes_.first(count);
    bytes_ = bytes_.subspan(count);
    return result;
  }
  Bytes rest() const { return bytes_; }

 private:
  Bytes bytes_;
};

class McapFile : public BagFile {
 public:
  explicit McapFile(const std::string& path) : path_(path), file_(path) { file_.skip(kMagicBytes); }

  const std::map<std::uint32_t, Connection>& connections() const override { return connections_; }

  std::optional<ConnectionMessage> next() override {
    try {
      while (true) {
        if (!in_chunk_.empty()) {
          if (auto message = message_in_chunk()) return message;
          continue;
        }
        Bytes header;
        if (!file_.read(kRecordHeader, header)) return std::nullopt;
        const std::uint8_t opcode = header[0];
        const auto length = little_endian<std::uint64_t>(header, 1);
        const bool wanted =
            opcode == kSchema || opcode == kChannel || opcode == kMessage || opcode == kChunk;
        if (!wanted) {
          if (!file_.skip(length)) return std::nullopt;
          continue;
        }
        if (length > kMaxChunkBytes) {
          throw Error(fmt::format("expected records of at most {} bytes, found one of {}",
                                  kMaxChunkBytes, length));
        }
        Bytes record;
        if (!file_.read(length, record)) return std::nullopt;
        if (auto message = take(opcode, record)) return message;
      }
    } catch (const Error& error) {
      throw Error(
          fmt::format("{}: {}; the file is damaged, record it again or repair it with "
                      "'mcap recover'",
                      path_, error.what()));
    }
  }

 private:
  std::optional<ConnectionMessage> message_in_chunk() {
    if (in_chunk_.size() < kRecordHeader) {
      in_chunk_ = {};
      return std::nullopt;
    }
    const std::uint8_t opcode = in_chunk_[0];
    const auto length = little_endian<std::uint64_t>(in_chunk_, 1);
    Fields chunk(in_chunk_.subspan(kRecordHeader));
    const Bytes record = chunk.take(length);
    in_chunk_ = chunk.rest();
    return opcode == kChunk ? std::nullopt : take(opcode, record);
  }

  std::optional<ConnectionMessage> take(std::uint8_t opcode, Bytes record) {
    Fields fields(record);
    switch (opcode) {
      case kSchema: {
        const auto id = fields.number<std::uint16_t>();
        if (schemas_.size() < kMaxConnections) schemas_[id] = fields.words();
        return std::nullopt;
      }
      case kChannel: {
        const auto id = fields.number<std::uint16_t>();
        const auto schema = fields.number<std::uint16_t>();
        std::string topic = fields.words();
        if (fields.words() != "cdr") return std::nullopt;  // not ROS 2's
        connections_[id] = {std::move(topic), schemas_[schema]};
        return std::nullopt;
      }
      case kMessage: {
        ConnectionMessage result;
        result.connection = fields.number<std::uint16_t>();
        fields.number<std::uint32_t>();
        result.message.time_ns = static_cast<std::int64_t>(fields.number<std::uint64_t>());
        fields.number<std::uint64_t>();
        result.message.bytes = fields.rest();
        if (!connections_.contains(result.connection)) return std::nullopt;
        return result;
      }
      case kChunk:
        open_chunk(fields);
        return std::nullopt;
      default:
        return std::nullopt;
    }
  }

  void open_chunk(Fields& fields) {
    fields.number<std::uint64_t>();
    fields.number<std::uint64_t>();
    const auto size = fields.number<std::uint64_t>();
    fields.number<std::uint32_t>();
    const std::string compression = fields.words();
    const Bytes records = fields.take(fields.number<std::uint64_t>());
    chunk_ = decompressed(records, compression, size);
    in_chunk_ = chunk_;
  }

  std::string path_;
  FileBytes file_;
  std::map<std::uint32_t, Connection> connections_;
  std::map<std::uint16_t, std::string> schemas_;
  std::vector<std::uint8_t> chunk_;
  Bytes in_chunk_;  ///< the records of the chunk that were not taken yet
};

std::unique_ptr<BagFile> open_file(const std::string& path) {
  return std::make_unique<McapFile>(path);
}

}  // namespace

std::unique_ptr<Bag> open_mcap(const std::string& path) {
  return scanned_bag(path, "MCAP file", open_file);
}

}  // namespace hqslam::recordings

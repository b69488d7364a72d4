#include "bags/bag.h"
#include "hqslam/core/error.h"

namespace hqslam::recordings {

namespace {

constexpr std::uint64_t kMagicBytes = 8;
constexpr std::uint64_t kRecordHeader = 9;  // opcode and length
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
      throw Error("expected {} more bytes of a record, found {}", count, bytes_.size());
    }
    const Bytes result = bytes_.first(count);
    bytes_ = bytes_.subspan(count);
    return result;
  }
  Bytes rest() const { return bytes_; }

 private:
  Bytes bytes_;
};

class McapFile : public ScannedBag {
 public:
  explicit McapFile(const std::string& path)
      : ScannedBag(path, kMagicBytes, kMagicBytes,
                   "the file is damaged, record it again or repair it with 'mcap recover'") {}

 private:
  bool read_record(std::optional<Message>& message) override {
    Bytes bytes;
    if (!read(kRecordHeader, bytes)) return false;
    const std::uint8_t opcode = bytes[0];
    const auto length = little_endian<std::uint64_t>(bytes, 1);
    if (opcode < kSchema || opcode > kChunk) return skip(length);
    if (!read(length, bytes)) return false;
    Fields fields(bytes);
    if (opcode == kSchema) {
      const auto id = fields.number<std::uint16_t>();
      schemas_[id] = fields.words().substr(0, kMaxNameBytes + 1);  // what is too long stays so
    } else if (opcode == kChannel) {
      const auto id = fields.number<std::uint16_t>();
      const auto schema = fields.number<std::uint16_t>();
      std::string topic = fields.words();
      const std::string encoding = fields.words();
      if (encoding == "cdr" || encoding.empty())
        add_topic(id, {std::move(topic), schemas_[schema]});
    } else if (opcode == kMessage) {
      message.emplace();
      message->stream = fields.number<std::uint16_t>();
      fields.number<std::uint32_t>();
      message->time_ns = static_cast<std::int64_t>(fields.number<std::uint64_t>());
      fields.number<std::uint64_t>();
      message->bytes = fields.rest();
    } else {
      take_chunk(fields);
    }
    return true;
  }

  void take_chunk(Fields& fields) {
    fields.number<std::uint64_t>();
    fields.number<std::uint64_t>();
    const auto size = fields.number<std::uint64_t>();
    fields.number<std::uint32_t>();
    const std::string compression = fields.words();
    open_chunk(fields.take(fields.number<std::uint64_t>()), compression, size);
  }

  std::map<std::uint16_t, std::string> schemas_;
};

}  // namespace

std::unique_ptr<BagFile> open_mcap(const std::string& path) {
  return std::make_unique<McapFile>(path);
}

}  // namespace hqslam::recordings

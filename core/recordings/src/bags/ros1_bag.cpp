#include <algorithm>

#include "bags/bag.h"
#include "hqslam/core/error.h"

namespace hqslam::recordings {

namespace {

constexpr std::uint64_t kVersionLine = 13;  // "#ROSBAG V2.0\n"
constexpr std::size_t kMaxHeaderBytes = 1U << 20U;
enum RosOpcode : std::uint8_t { kRosMessage = 2, kRosChunk = 5, kRosConnection = 7 };

/// The fields "name=value" of a record's header. Throws Error.
std::map<std::string, Bytes> fields_of(Bytes header) {
  if (header.size() > kMaxHeaderBytes) {
    throw Error("expected a header of at most {} bytes, found {}", kMaxHeaderBytes, header.size());
  }
  std::map<std::string, Bytes> fields;
  while (!header.empty()) {
    if (header.size() < 4 || little_endian<std::uint32_t>(header, 0) > header.size() - 4) {
      throw Error("expected a field of a record, found its end");
    }
    const Bytes field = header.subspan(4, little_endian<std::uint32_t>(header, 0));
    header = header.subspan(4 + field.size());
    const auto equals = std::ranges::find(field, std::uint8_t{'='});
    if (equals == field.end())
      throw Error("expected a field NAME=VALUE of a record, found another");
    const auto at = static_cast<std::size_t>(equals - field.begin());
    fields[std::string(field.begin(), equals)] = field.subspan(at + 1);
  }
  return fields;
}

template <typename T>
T number(const std::map<std::string, Bytes>& fields, const char* name) {
  const auto found = fields.find(name);
  if (found == fields.end() || found->second.size() < sizeof(T)) {
    throw Error("expected a record with field '{}', found none", name);
  }
  return little_endian<T>(found->second, 0);
}

std::string words(const std::map<std::string, Bytes>& fields, const char* name) {
  const auto found = fields.find(name);
  return found == fields.end() ? "" : std::string(found->second.begin(), found->second.end());
}

class Ros1File : public ScannedBag {
 public:
  explicit Ros1File(const std::string& path)
      : ScannedBag(path, kVersionLine, 0, "the bag is damaged, repair it with 'rosbag reindex'") {}

 private:
  bool read_record(std::optional<Message>& message) override {
    Bytes bytes;
    if (!read(4, bytes)) return false;
    const std::uint64_t header_bytes = little_endian<std::uint32_t>(bytes, 0);
    if (!read(header_bytes, bytes)) return false;
    const std::vector<std::uint8_t> header(bytes.begin(), bytes.end());
    const auto fields = fields_of(header);
    if (!read(4, bytes) || !read(little_endian<std::uint32_t>(bytes, 0), bytes)) return false;
    const auto opcode = number<std::uint8_t>(fields, "op");
    if (opcode == kRosConnection) {
      add_topic(number<std::uint32_t>(fields, "conn"),
                {words(fields, "topic"), words(fields_of(bytes), "type")});
    } else if (opcode == kRosMessage) {
      const auto time = number<std::uint64_t>(fields, "time");
      message.emplace();
      message->stream = number<std::uint32_t>(fields, "conn");
      message->time_ns = static_cast<std::int64_t>(time & 0xFFFFFFFFU) * 1'000'000'000 +
                         static_cast<std::int64_t>(time >> 32U);
      message->bytes = bytes;
      message->ros1 = true;
    } else if (opcode == kRosChunk) {
      open_chunk(bytes, words(fields, "compression"), number<std::uint32_t>(fields, "size"));
    }
    return true;
  }
};

}  // namespace

std::unique_ptr<BagFile> open_ros1_bag(const std::string& path) {
  return std::make_unique<Ros1File>(path);
}

}  // namespace hqslam::recordings

#include <fmt/format.h>

#include <algorithm>

#include "decompress.h"
#include "hqslam/core/error.h"
#include "scanned_bag.h"

namespace hqslam::recordings {

namespace {

constexpr std::uint64_t kVersionLine = 13;  // "#ROSBAG V2.0\n"
constexpr std::size_t kMaxHeaderBytes = 1U << 20U;
constexpr std::size_t kMaxConnections = 65536;
enum Opcode : std::uint8_t { kMessage = 2, kChunk = 5, kConnection = 7 };

/// The fields "name=value" of a record's header. Throws Error.
std::map<std::string, Bytes> fields_of(Bytes header) {
  std::map<std::string, Bytes> fields;
  while (!header.empty()) {
    if (header.size() < 4 || little_endian<std::uint32_t>(header, 0) > header.size() - 4) {
      throw Error("expected a field of a record, found its end");
    }
    const Bytes field = header.subspan(4, little_endian<std::uint32_t>(header, 0));
    header = header.subspan(4 + field.size());
    const auto equals = std::find(field.begin(), field.end(), std::uint8_t{'='});
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
    throw Error(fmt::format("expected a record with field '{}', found none", name));
  }
  return little_endian<T>(found->second, 0);
}

std::string words(const std::map<std::string, Bytes>& fields, const char* name) {
  const auto found = fields.find(name);
  return found == fields.end() ? "" : std::string(found->second.begin(), found->second.end());
}

class Ros1File : public BagFile {
 public:
  explicit Ros1File(const std::string& path) : path_(path), file_(path) {
    file_.skip(kVersionLine);
  }

  const std::map<std::uint32_t, Connection>& connections() const override { return connections_; }

  std::optional<ConnectionMessage> next() override {
    try {
      while (true) {
        if (!in_chunk_.empty()) {
          if (auto message = message_in_chunk()) return message;
          continue;
        }
        if (!read_record()) return std::nullopt;
        if (auto message = take(header_, data_)) return message;
      }
    } catch (const Error& error) {
      throw Error(fmt::format("{}: {}; the bag is damaged, repair it with 'rosbag reindex'", path_,
                              error.what()));
    }
  }

 private:
  bool read_record() {
    Bytes bytes;
    if (!file_.read(4, bytes)) return false;
    const std::uint64_t header_bytes = little_endian<std::uint32_t>(bytes, 0);
    if (header_bytes > kMaxHeaderBytes) {
      throw Error(fmt::format("expected a header of at most {} bytes, found {}", kMaxHeaderBytes,
                              header_bytes));
    }
    if (!file_.read(header_bytes, bytes)) return false;
    header_.assign(bytes.begin(), bytes.end());
    if (!file_.read(4, bytes)) return false;
    const std::uint64_t data_bytes = little_endian<std::uint32_t>(bytes, 0);
    if (data_bytes > kMaxChunkBytes) {
      throw Error(fmt::format("expected records of at most {} bytes, found one of {}",
                              kMaxChunkBytes, data_bytes));
    }
    return file_.read(data_bytes, data_);
  }

  Bytes part_of_chunk() {
    if (in_chunk_.size() < 4 || little_endian<std::uint32_t>(in_chunk_, 0) > in_chunk_.size() - 4) {
      throw Error("expected a record in a chunk, found its end");
    }
    const Bytes part = in_chunk_.subspan(4, little_endian<std::uint32_t>(in_chunk_, 0));
    in_chunk_ = in_chunk_.subspan(4 + part.size());
    return part;
  }

  std::optional<ConnectionMessage> message_in_chunk() {
    const Bytes header = part_of_chunk();
    const Bytes data = part_of_chunk();
    const auto fields = fields_of(header);
    return number<std::uint8_t>(fields, "op") == kChunk ? std::nullopt : take(header, data);
  }

  std::optional<ConnectionMessage> take(Bytes header, Bytes data) {
    const auto fields = fields_of(header);
    switch (number<std::uint8_t>(fields, "op")) {
      case kConnection: {
        const auto id = number<std::uint32_t>(fields, "conn");
        if (connections_.size() >= kMaxConnections) return std::nullopt;
        connections_[id] = {words(fields, "topic"), words(fields_of(data), "type")};
        return std::nullopt;
      }
      case kMessage: {
        ConnectionMessage result;
        result.connection = number<std::uint32_t>(fields, "conn");
        const auto time = number<std::uint64_t>(fields, "time");
        result.message.time_ns = static_cast<std::int64_t>(time & 0xFFFFFFFFU) * 1'000'000'000 +
                                 static_cast<std::int64_t>(time >> 32U);
        result.message.bytes = data;
        result.message.ros1 = true;
        if (!connections_.contains(result.connection)) return std::nullopt;
        return result;
      }
      case kChunk:
        chunk_ =
            decompressed(data, words(fields, "compression"), number<std::uint32_t>(fields, "size"));
        in_chunk_ = chunk_;
        return std::nullopt;
      default:
        return std::nullopt;
    }
  }

  std::string path_;
  FileBytes file_;
  std::vector<std::uint8_t> header_;
  Bytes data_;
  std::map<std::uint32_t, Connection> connections_;
  std::vector<std::uint8_t> chunk_;
  Bytes in_chunk_;
};

std::unique_ptr<BagFile> open_file(const std::string& path) {
  return std::make_unique<Ros1File>(path);
}

}  // namespace

std::unique_ptr<Bag> open_ros1_bag(const std::string& path) {
  return scanned_bag(path, "ROS 1 bag", open_file);
}

}  // namespace hqslam::recordings

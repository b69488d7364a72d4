#include "scanned_bag.h"

#include <fmt/format.h>

#include <filesystem>

#include "decompress.h"
#include "hqslam/core/error.h"

namespace hqslam::recordings {

namespace {

class ScannedMessages : public MessageSource {
 public:
  ScannedMessages(std::unique_ptr<BagFile> file, std::string topic)
      : file_(std::move(file)), topic_(std::move(topic)) {}

  std::optional<Message> next() override {
    while (const auto found = file_->next()) {
      if (file_->connections().at(found->connection).topic == topic_) return found->message;
    }
    return std::nullopt;
  }

 private:
  std::unique_ptr<BagFile> file_;
  std::string topic_;
};

class ScannedBag : public Bag {
 public:
  ScannedBag(const std::string& path, std::string kind, OpenBagFile open)
      : path_(path), kind_(std::move(kind)), open_(open) {
    const auto file = open_(path_);
    std::map<std::uint32_t, std::int64_t> messages;
    while (const auto found = file->next()) ++messages[found->connection];
    for (const auto& [id, connection] : file->connections()) {
      add_topic(topics_, {connection.topic, connection.type, messages[id]});
    }
  }

  std::string kind() const override { return kind_; }
  const std::vector<Topic>& topics() const override { return topics_; }
  std::unique_ptr<MessageSource> messages(const std::string& topic) const override {
    return std::make_unique<ScannedMessages>(open_(path_), topic);
  }

 private:
  std::string path_;
  std::string kind_;
  OpenBagFile open_;
  std::vector<Topic> topics_;
};

}  // namespace

std::unique_ptr<Bag> scanned_bag(const std::string& path, const std::string& kind,
                                 OpenBagFile open) {
  return std::make_unique<ScannedBag>(path, kind, open);
}

BagFile::BagFile(const std::string& path, std::uint64_t first_bytes, std::string repair)
    : path_(path), repair_(std::move(repair)), stream_(path, std::ios::binary) {
  std::error_code error;
  left_ = std::filesystem::file_size(path, error);
  if (error || !stream_) {
    throw Error(
        fmt::format("{}: expected a bag, found a file that cannot be read; check its "
                    "permissions",
                    path));
  }
  skip(first_bytes);
}

std::optional<ConnectionMessage> BagFile::next() {
  try {
    while (true) {
      in_chunk_ = !left_of_chunk_.empty();
      std::optional<ConnectionMessage> message;
      if (!read_record(message)) return std::nullopt;
      if (message && connections_.contains(message->connection)) return message;
    }
  } catch (const Error& error) {
    throw Error(fmt::format("{}: {}; {}", path_, error.what(), repair_));
  }
}

bool BagFile::read(std::uint64_t count, Bytes& bytes) {
  if (count > kMaxChunkBytes) {
    throw Error(fmt::format("expected records of at most {} bytes, found one of {}", kMaxChunkBytes,
                            count));
  }
  if (in_chunk_) {
    if (count > left_of_chunk_.size()) {
      throw Error(
          fmt::format("expected {} more bytes of a chunk, found {}", count, left_of_chunk_.size()));
    }
    bytes = left_of_chunk_.first(count);
    left_of_chunk_ = left_of_chunk_.subspan(count);
    return true;
  }
  if (count > left_) return false;
  buffer_.resize(count);
  stream_.read(reinterpret_cast<char*>(buffer_.data()), static_cast<std::streamsize>(count));
  left_ -= count;
  bytes = buffer_;
  return static_cast<bool>(stream_);
}

bool BagFile::skip(std::uint64_t count) {
  Bytes skipped;
  if (in_chunk_) return read(count, skipped);
  if (count > left_) return false;
  stream_.seekg(static_cast<std::streamoff>(count), std::ios::cur);
  left_ -= count;
  return static_cast<bool>(stream_);
}

void BagFile::open_chunk(Bytes packed, const std::string& compression, std::uint64_t size) {
  if (in_chunk_) return;
  chunk_ = decompressed(packed, compression, size);
  left_of_chunk_ = chunk_;
}

void BagFile::add_connection(std::uint32_t id, Connection connection) {
  constexpr std::size_t kMaxConnections = 65536;
  if (connections_.size() < kMaxConnections) connections_[id] = std::move(connection);
}

}  // namespace hqslam::recordings

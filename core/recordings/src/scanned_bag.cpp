#include "scanned_bag.h"

#include <fmt/format.h>

#include <filesystem>

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

FileBytes::FileBytes(const std::string& path) : stream_(path, std::ios::binary) {
  std::error_code error;
  size_ = std::filesystem::file_size(path, error);
  if (error || !stream_) {
    throw Error(
        fmt::format("{}: expected a bag, found a file that cannot be read; check its "
                    "permissions",
                    path));
  }
}

bool FileBytes::read(std::uint64_t count, Bytes& bytes) {
  if (count > left()) return false;
  buffer_.resize(count);
  stream_.read(reinterpret_cast<char*>(buffer_.data()), static_cast<std::streamsize>(count));
  if (static_cast<std::uint64_t>(stream_.gcount()) != count) return false;
  at_ += count;
  bytes = buffer_;
  return true;
}

bool FileBytes::skip(std::uint64_t count) {
  if (count > left()) return false;
  stream_.seekg(static_cast<std::streamoff>(count), std::ios::cur);
  at_ += count;
  return static_cast<bool>(stream_);
}

}  // namespace hqslam::recordings

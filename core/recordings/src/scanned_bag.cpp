#include "scanned_bag.h"

#include <fmt/format.h>

#include <filesystem>

#include "decompress.h"
#include "hqslam/core/error.h"

namespace hqslam::recordings {

ScannedBag::ScannedBag(const std::string& path, std::uint64_t first_bytes, std::string repair)
    : path_(path), repair_(std::move(repair)), stream_(path, std::ios::binary) {
  std::error_code error;
  bytes_ = std::filesystem::file_size(path, error);
  left_ = bytes_;
  if (error || !stream_) {
    throw Error(
        fmt::format("{}: expected a bag, found a file that cannot be read; check its "
                    "permissions",
                    path));
  }
  skip(first_bytes);
}

std::optional<Message> ScannedBag::next() {
  try {
    while (true) {
      in_chunk_ = !left_of_chunk_.empty();
      std::optional<Message> message;
      if (!read_record(message)) return std::nullopt;
      if (message && topics_.contains(static_cast<std::uint32_t>(message->stream))) return message;
    }
  } catch (const Error& error) {
    throw Error(fmt::format("{}: {}; {}", path_, error.what(), repair_));
  }
}

bool ScannedBag::read(std::uint64_t count, Bytes& bytes) {
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

bool ScannedBag::skip(std::uint64_t count) {
  Bytes skipped;
  if (in_chunk_) return read(count, skipped);
  if (count > left_) return false;
  stream_.seekg(static_cast<std::streamoff>(count), std::ios::cur);
  left_ -= count;
  return static_cast<bool>(stream_);
}

void ScannedBag::open_chunk(Bytes packed, const std::string& compression, std::uint64_t size) {
  if (in_chunk_) return;
  chunk_ = decompressed(packed, compression, size);
  left_of_chunk_ = chunk_;
}

void ScannedBag::add_topic(std::uint32_t id, Topic topic) {
  constexpr std::size_t kMaxTopics = 65536;
  if (topics_.size() < kMaxTopics) topics_[id] = std::move(topic);
}

double ScannedBag::read_share() const {
  return bytes_ > 0 ? 1.0 - static_cast<double>(left_) / static_cast<double>(bytes_) : 1.0;
}

}  // namespace hqslam::recordings

#include <bzlib.h>
#include <fmt/format.h>
#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>

#include "bags/bag.h"
#include "hqslam/core/error.h"
#include "hqslam/core/excerpt.h"
#include "hqslam/core/whole_file.h"

namespace hqslam::recordings {

namespace {

/// A block grows at most by this factor, which zeros reach; one that claims more is refused before
/// memory is taken.
constexpr std::uint64_t kMaxRatio = 100'000;

bool from_lz4(Bytes chunk, std::vector<std::uint8_t>& result) {
  LZ4F_dctx* raw = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&raw, LZ4F_VERSION)) != 0) return false;
  const auto free = [](LZ4F_dctx* context) { LZ4F_freeDecompressionContext(context); };
  const std::unique_ptr<LZ4F_dctx, decltype(free)> context(raw);
  std::size_t read = 0;
  std::size_t written = 0;
  while (read < chunk.size()) {
    std::size_t source = chunk.size() - read;
    std::size_t target = result.size() - written;
    const std::size_t status = LZ4F_decompress(raw, result.data() + written, &target,
                                               chunk.data() + read, &source, nullptr);
    if (LZ4F_isError(status) != 0) return false;
    read += source;
    written += target;
    if (status == 0) break;  // the frame has ended
    if (source == 0 && target == 0) return false;
  }
  return written == result.size();
}

bool from_zstd(Bytes chunk, std::vector<std::uint8_t>& result) {
  const std::size_t written =
      ZSTD_decompress(result.data(), result.size(), chunk.data(), chunk.size());
  return ZSTD_isError(written) == 0 && written == result.size();
}

bool from_bz2(Bytes chunk, std::vector<std::uint8_t>& result) {
  auto written = static_cast<unsigned int>(result.size());
  std::vector<char> source(chunk.begin(), chunk.end());  // its interface wants them writable
  const int status =
      BZ2_bzBuffToBuffDecompress(reinterpret_cast<char*>(result.data()), &written, source.data(),
                                 static_cast<unsigned int>(source.size()), 0, 0);
  return status == BZ_OK && written == result.size();
}

/// The content of a chunk; compression: "" or "none" (as it is), "lz4" (frames), "zstd" or "bz2".
/// Throws Error, without the file's name, for content of another size and for other compressions.
std::vector<std::uint8_t> decompressed(Bytes chunk, const std::string& compression,
                                       std::uint64_t size) {
  if (size > kMaxChunkBytes || size > kMaxRatio * (chunk.size() + 1) || chunk.size() > UINT32_MAX) {
    throw Error("expected a chunk of at most {} bytes, found one of {} in {}", kMaxChunkBytes, size,
                chunk.size());
  }
  if (compression.empty() || compression == "none") {
    if (size != chunk.size()) {
      throw Error("expected a stored chunk of {} bytes, found {}", size, chunk.size());
    }
    return {chunk.begin(), chunk.end()};
  }
  std::vector<std::uint8_t> result(size);
  const bool whole = compression == "lz4"    ? from_lz4(chunk, result)
                     : compression == "zstd" ? from_zstd(chunk, result)
                     : compression == "bz2"  ? from_bz2(chunk, result)
                                             : false;
  if (!whole) {
    throw Error(
        "expected a chunk of {} bytes compressed by lz4, zstd or bz2, found a damaged one ('{}')",
        size, excerpt(compression, kNameCharacters));
  }
  return result;
}

}  // namespace

ScannedBag::ScannedBag(const std::string& path, std::uint64_t first_bytes, std::uint64_t last_bytes,
                       std::string repair)
    : path_(path),
      repair_(std::move(repair)),
      last_bytes_(last_bytes),
      stream_(open_file(path, "a bag")) {
  std::error_code error;
  bytes_ = std::filesystem::file_size(path, error);
  left_ = error ? 0 : bytes_;
  skip(first_bytes);
}

std::optional<Message> ScannedBag::next() {
  try {
    while (!is_cut_off_) {
      in_chunk_ = !left_of_chunk_.empty();
      std::optional<Message> message;
      const std::uint64_t left_before = left_;
      if (!read_record(message)) {
        is_cut_off_ = left_before != last_bytes_;
        break;
      }
      if (message && topics_.contains(static_cast<std::uint32_t>(message->stream))) return message;
    }
    return std::nullopt;
  } catch (const Error& error) {
    throw Error("{}: {}; {}", path_, error.what(), repair_);
  }
}

bool ScannedBag::read(std::uint64_t count, Bytes& bytes) {
  if (count > kMaxChunkBytes) {
    throw Error("expected records of at most {} bytes, found one of {}", kMaxChunkBytes, count);
  }
  if (in_chunk_) {
    if (count > left_of_chunk_.size()) {
      throw Error("expected {} more bytes of a chunk, found {}", count, left_of_chunk_.size());
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

void BagFile::add_topic(std::uint32_t id, Topic topic) {
  constexpr std::size_t kMaxTopics = 10'000;
  if (topic.name.size() > kMaxNameBytes || topic.type.size() > kMaxNameBytes) return;
  if (topics_.size() < kMaxTopics) topics_[id] = std::move(topic);
}

bool is_packed(Bytes message) {
  constexpr std::array<std::uint8_t, 4> kZstd = {0x28, 0xB5, 0x2F, 0xFD};
  return message.size() >= kZstd.size() && std::ranges::equal(message.first(kZstd.size()), kZstd);
}

std::vector<std::uint8_t> unpacked_message(Bytes message) {
  const unsigned long long size = ZSTD_getFrameContentSize(message.data(), message.size());
  if (size > kMaxChunkBytes || size > kMaxRatio * message.size()) return {};
  std::vector<std::uint8_t> result(size);
  if (!from_zstd(message, result)) result.clear();
  return result;
}

std::string ScannedBag::missing() const {
  return is_cut_off_ ? fmt::format(
                           "the file ends within a record: it was cut off, and what was "
                           "recorded last is missing; {}",
                           repair_)
                     : "";
}

double ScannedBag::read_share() const {
  return bytes_ > 0 ? 1.0 - static_cast<double>(left_) / static_cast<double>(bytes_) : 1.0;
}

}  // namespace hqslam::recordings

#include "decompress.h"

#include <bzlib.h>
#include <fmt/format.h>
#include <lz4frame.h>
#include <zstd.h>

#include <memory>

#include "bag.h"
#include "hqslam/core/error.h"
#include "hqslam/core/excerpt.h"

namespace hqslam::recordings {

namespace {

/// So many times a block can grow: what claims more is refused before memory is taken. Zeros
/// compress best.
constexpr std::uint64_t kMaxRatio = 100'000;

struct FreeLz4 {
  void operator()(LZ4F_dctx* context) const { LZ4F_freeDecompressionContext(context); }
};

bool from_lz4(Bytes chunk, std::vector<std::uint8_t>& result) {
  LZ4F_dctx* raw = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&raw, LZ4F_VERSION)) != 0) return false;
  const std::unique_ptr<LZ4F_dctx, FreeLz4> context(raw);
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

}  // namespace

std::vector<std::uint8_t> decompressed(Bytes chunk, const std::string& compression,
                                       std::uint64_t size) {
  const bool stored = compression.empty() || compression == "none";
  if (size > kMaxChunkBytes || size > kMaxRatio * (chunk.size() + 1) || chunk.size() > UINT32_MAX) {
    throw Error(fmt::format("expected a chunk of at most {} bytes, found one of {} in {}",
                            kMaxChunkBytes, size, chunk.size()));
  }
  if (stored) {
    if (size != chunk.size()) {
      throw Error(fmt::format("expected a stored chunk of {} bytes, found {}", size, chunk.size()));
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
        fmt::format("expected a chunk of {} bytes compressed by lz4, zstd or bz2, found a "
                    "damaged one ('{}')",
                    size, excerpt(compression, kNameCharacters)));
  }
  return result;
}

}  // namespace hqslam::recordings

#include "message_reader.h"

#include <fmt/format.h>

#include "hqslam/core/error.h"

namespace hqslam::recordings {

namespace {

constexpr std::size_t kEncapsulation = 4;

[[noreturn]] void fail_for_end(std::size_t wanted, std::size_t left) {
  throw Error(
      fmt::format("expected {} more bytes of a message, found {}: the message is damaged or "
                  "of another type than the file says",
                  wanted, left));
}

}  // namespace

MessageReader::MessageReader(const Message& message) : bytes_(message.bytes), ros1_(message.ros1) {
  if (ros1_) return;
  if (bytes_.size() < kEncapsulation) fail_for_end(kEncapsulation, bytes_.size());
  big_endian_ = (bytes_[1] & 1U) == 0;
  begin_ = kEncapsulation;
  at_ = kEncapsulation;
}

std::uint64_t MessageReader::number(std::size_t size) {
  if (!ros1_) at_ += (size - (at_ - begin_) % size) % size;
  if (at_ > bytes_.size() || bytes_.size() - at_ < size) {
    fail_for_end(size, at_ > bytes_.size() ? 0 : bytes_.size() - at_);
  }
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < size; ++i) {
    const std::size_t from = big_endian_ ? i : size - 1 - i;
    value = value << 8U | bytes_[at_ + from];
  }
  at_ += size;
  return value;
}

Bytes MessageReader::bytes(std::size_t count) {
  if (left() < count) fail_for_end(count, left());
  const Bytes result = bytes_.subspan(at_, count);
  at_ += count;
  return result;
}

Bytes MessageReader::byte_list() { return bytes(u32()); }

std::string MessageReader::words() {
  const Bytes characters = byte_list();
  std::string text(characters.begin(), characters.end());
  if (!ros1_ && !text.empty() && text.back() == '\0') text.pop_back();
  return text;
}

std::int64_t MessageReader::time_ns() {
  const std::int64_t seconds = ros1_ ? std::int64_t{u32()} : std::int64_t{i32()};
  return seconds * 1'000'000'000 + u32();
}

std::int64_t MessageReader::header_ns() {
  if (ros1_) u32();  // a running number
  const std::int64_t time = time_ns();
  words();
  return time;
}

}  // namespace hqslam::recordings

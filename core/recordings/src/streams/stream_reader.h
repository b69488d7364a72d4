#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bags/imu_stream.h"
#include "recording_file.h"

namespace hqslam::recordings {

/// A text of a bag, and the topic that it is of.
struct TopicText {
  std::string topic;
  std::string text;
};

/// One stream of a capture or a bag, which is read once: the reader keeps the messages from which
/// it finds the streams and their content, and gives them first.
class StreamReader {
 public:
  /// Reads on until the streams with scans are known: those that send within two seconds of the
  /// first one. `wanted`: as OpenOptions::stream. Throws Error unless one is to be read.
  StreamReader(const std::string& path, const std::string& wanted);

  const std::string& path() const { return path_; }
  const RecordingFile& file() const { return *file_; }
  const Stream& stream() const { return file_->streams()[chosen_]; }
  /// What add_metadata found before the stream's messages or among the first.
  const std::vector<TopicText>& metadata() const { return metadata_; }
  /// The first packet of settings (DIFOP) of the sensor that sent the stream; empty: none came so
  /// soon.
  Bytes settings() const;
  /// The stream of the inertial data that belong to this one; the taker gets its messages between
  /// those of the stream, in the order of the file.
  const ImuStream& imu() const { return imu_; }
  void give_imu_to(std::function<void(const Message&)> taker) { take_imu_ = std::move(taker); }
  /// The message `index` behind the next one, without taking it; nothing at the end, or where more
  /// than kMostKept_bytes would have to be kept.
  std::optional<Message> ahead(std::size_t index);
  /// Messages of other streams need not be read, be it only to count them.
  void skip_others();
  std::optional<Message> next();
  /// How much of the file stands before the next message, 0 to 1.
  double read_share() const { return share_; }
  /// Streams with scans that began later than this one was chosen, and are not read; "" or a line.
  std::string passed_over() const;

  static constexpr std::size_t kMostKept_bytes = std::size_t{64} << 20U;

 private:
  struct Kept {
    Message message;  ///< of these bytes
    std::vector<std::uint8_t> bytes;
    double share = 0.0;
    std::int64_t number = 0;  ///< of all that were kept

    std::size_t memory_bytes() const { return sizeof(Kept) + bytes.size(); }
  };

  void listen();
  std::size_t chosen() const;
  void keep(const Message& message, std::deque<Kept>& where);
  /// The stream's next message in the file; those of inertial data before it are kept or given.
  std::optional<Message> read(bool keeps_imu);
  /// Gives those that stand before the kept message of that number.
  void give_kept_imu(std::int64_t before);

  std::string path_;
  std::string wanted_;
  std::unique_ptr<RecordingFile> file_;
  std::size_t chosen_ = 0;
  std::vector<TopicText> metadata_;
  std::map<std::array<std::uint8_t, 16>, std::vector<std::uint8_t>> settings_;  ///< by sender
  StaticTransforms transforms_;
  ImuStream imu_;
  std::function<void(const Message&)> take_imu_ = [](const Message&) {};
  std::deque<Kept> kept_;
  std::deque<Kept> kept_imu_;
  std::size_t kept_bytes_ = 0;
  std::int64_t kept_messages_ = 0;
  Kept current_;
  double share_ = 0.0;
};

/// An Ouster's metadata are shorter, and a bag has fewer of them.
inline constexpr std::size_t kMostMetadata_bytes = std::size_t{1} << 20U;
inline constexpr std::size_t kMostMetadataTexts = 64;

/// Puts the message's text to the others if it is an Ouster's metadata in a topic of such. What is
/// damaged or beyond these limits is passed over.
void add_metadata(const Stream& stream, const Message& message, std::vector<TopicText>& texts);

}  // namespace hqslam::recordings

#include "recording_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <map>
#include <string_view>
#include <utility>

#include "bags/bag.h"
#include "bags/message_packets.h"
#include "hqslam/core/error.h"
#include "hqslam/core/excerpt.h"
#include "packets/hesai_decoder.h"
#include "packets/ouster_decoder.h"
#include "packets/ouster_metadata.h"

namespace hqslam::recordings {

namespace {

namespace fs = std::filesystem;

/// Whether messages of a type that is read begin with a stamp.
bool is_stamped(const std::string& type) {
  return type.starts_with("sensor_msgs/") || type.starts_with("velodyne_msgs/") ||
         type.starts_with("pandar_msgs/") || type.starts_with("nebula_msgs/");
}

/// "" for a damaged message.
std::string frame_of(const Message& message) {
  try {
    return excerpt(MessageReader(message).header().frame, kNameCharacters);
  } catch (const Error&) {
    return "";
  }
}

/// What the messages of a stream are, by this one.
void recognize(Stream& stream, const Message& message) {
  const std::string type = plain_type(stream.type);
  if (stream.messages == 1 && is_stamped(type)) stream.frame = frame_of(message);
  if (type == "sensor_msgs/PointCloud2") stream.kind = StreamKind::kPointClouds;
  if (type == "sensor_msgs/Imu") stream.kind = StreamKind::kInertialData;
  if (stream.packet_bytes > 0 || stream.type.empty() || !carries_packets(stream.type)) return;
  const auto packet = first_packet_of(stream, message);
  stream.packet_bytes = packet ? packet->payload.size() : 0;
  if (stream.packet_bytes == kVelodynePacketBytes) {
    stream.kind = StreamKind::kVelodynePackets;
  } else if (packet && hesai_packet(packet->payload)) {
    stream.kind = StreamKind::kHesaiPackets;
  } else if (type.ends_with("/PacketMsg") && stream.packet_bytes >= kSmallestLidarPacket) {
    stream.kind = StreamKind::kOusterPackets;
  } else if (type.ends_with("/PacketMsg") && stream.packet_bytes == kOusterImuBytes) {
    stream.kind = StreamKind::kInertialData;
  }
}

class BagRecording : public RecordingFile {
 public:
  /// missing: files that metadata.yaml lists and that are not there; "" or one line.
  BagRecording(std::vector<std::string> paths, std::string kind, OpenBagFile open,
               std::string missing)
      : paths_(std::move(paths)),
        kind_(std::move(kind)),
        open_(open),
        file_(open(paths_.front())),
        missing_(std::move(missing)) {}

  std::string kind() const override { return kind_; }
  std::string missing() const override { return missing_; }

  std::optional<Message> next() override {
    while (true) {
      if (auto message = file_->next()) {
        message->stream = stream_of(static_cast<std::uint32_t>(message->stream));
        if (is_packed(message->bytes)) {
          unpacked_ = unpacked_message(message->bytes);
          message->bytes = unpacked_;
        }
        Stream& stream = streams_[message->stream];
        ++stream.messages;
        recognize(stream, *message);
        return message;
      }
      note_cut();
      if (part_ + 1 == paths_.size()) return std::nullopt;
      file_ = open_(paths_[++part_]);
      stream_of_topic_.clear();
      if (!kept_.empty()) file_->keep_only(kept_);
    }
  }

  void keep_only(const std::vector<std::size_t>& streams) override {
    for (const std::size_t stream : streams) kept_.push_back(topics_[stream]);
    file_->keep_only(kept_);
  }

  double read_share() const override {
    return (static_cast<double>(part_) + file_->read_share()) / static_cast<double>(paths_.size());
  }

 private:
  /// Whether the file that was read to its end should have gone on.
  void note_cut() {
    if (const std::string text = file_->missing(); !text.empty()) {
      missing_ = paths_.size() > 1 ? fmt::format("{}: {}", paths_[part_], text) : text;
    }
  }

  /// Topics of one name are one stream, whichever file they are in.
  std::size_t stream_of(std::uint32_t topic) {
    const auto [found, is_new] = stream_of_topic_.try_emplace(topic, streams_.size());
    if (!is_new) return found->second;
    const Topic& of = file_->topics().at(topic);
    for (found->second = 0; found->second < topics_.size(); ++found->second) {
      if (topics_[found->second] == of.name) return found->second;
    }
    topics_.push_back(of.name);
    streams_.push_back(
        {.name = excerpt(of.name, kNameCharacters), .type = excerpt(of.type, kNameCharacters)});
    return found->second;
  }

  std::vector<std::string> paths_;
  std::string kind_;
  OpenBagFile open_;
  std::unique_ptr<BagFile> file_;
  std::size_t part_ = 0;
  std::map<std::uint32_t, std::size_t> stream_of_topic_;  ///< of the file that is open
  std::vector<std::string> topics_;                       ///< their names as the bag has them
  std::vector<std::string> kept_;
  std::string missing_;
  std::vector<std::uint8_t> unpacked_;
};

using Paths = std::vector<std::string>;

/// By what a file begins with.
struct FileForm {
  std::string_view magic;
  const char* kind = nullptr;
  OpenBagFile open = nullptr;  ///< of a bag
};
constexpr FileForm kDb3 = {"SQLite format 3", "ROS 2 bag (sqlite)", open_db3};
constexpr FileForm kMcap = {"\x89MCAP0\r\n", "MCAP file", open_mcap};
constexpr std::array<FileForm, 8> kForms = {{{"\xD4\xC3\xB2\xA1"},
                                             {"\xA1\xB2\xC3\xD4"},
                                             {"\x4D\x3C\xB2\xA1"},
                                             {"\xA1\xB2\x3C\x4D"},
                                             {"\x0A\x0D\x0D\x0A"},
                                             kDb3,
                                             kMcap,
                                             {"#ROSBAG V2.0\n", "ROS 1 bag", open_ros1_bag}}};

/// The files of a ROS 2 bag's folder, in natural order; empty if it is none. Throws Error for one
/// of compressed files alone.
Paths files_of_bag(const fs::path& folder) {
  Paths paths;
  std::string packed;
  std::error_code error;
  if (!fs::is_regular_file(folder / "metadata.yaml", error)) return paths;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string extension = entry->path().extension().string();
    if (extension == ".db3" || extension == ".mcap") paths.push_back(entry->path().string());
    if (extension == ".zstd") packed = entry->path().string();
  }
  if (paths.empty() && !packed.empty()) {
    throw Error("{}: expected .db3 or .mcap files, found compressed ones; unpack them: unzstd {}",
                folder.string(), packed);
  }
  // name_2.db3 comes before name_10.db3: numbers are not padded.
  std::ranges::sort(paths, {}, [](const std::string& p) { return std::pair(p.size(), p); });
  return paths;
}

/// Names the files that a bag's metadata.yaml lists and that are missing; "" where none is.
std::string missing_files(const fs::path& folder) {
  std::string names;
  std::error_code error;
  if (!fs::is_directory(folder, error)) return names;
  std::ifstream metadata(folder / "metadata.yaml");
  bool listed = false;
  for (std::string line; std::getline(metadata, line);) {
    const std::size_t dash = line.find("- ");
    if (dash == std::string::npos) {
      listed = line.find("relative_file_paths:") != std::string::npos;
    } else if (const std::string name = line.substr(dash + 2);
               listed && name.size() < kMaxNameBytes && !fs::exists(folder / name, error)) {
      names += fmt::format(" {}", excerpt(name));
      if (names.size() > kMaxNameBytes) break;
    }
  }
  if (names.empty()) return names;
  return fmt::format("files that metadata.yaml lists are missing:{}", names);
}

/// The form of a capture or a bag, and its files; nothing for what is none.
std::optional<FileForm> form_of(const std::string& path, Paths& files) {
  std::error_code error;
  files = {path};
  if (fs::is_directory(path, error)) {
    files = files_of_bag(path);
    if (files.empty()) return std::nullopt;
    return files.front().ends_with(".mcap") ? kMcap : kDb3;
  }
  if (!fs::is_regular_file(path, error)) return std::nullopt;
  std::array<char, 16> head{};
  std::ifstream(path, std::ios::binary).read(head.data(), head.size());
  const std::string_view beginning(head.data(), head.size());
  const auto form = std::ranges::find_if(
      kForms, [&](const FileForm& known) { return beginning.starts_with(known.magic); });
  return form == kForms.end() ? std::nullopt : std::optional(*form);
}

}  // namespace

std::unique_ptr<RecordingFile> open_recording_file(const std::string& path) {
  Paths files;
  const auto form = form_of(path, files);
  if (!form) {
    std::error_code error;
    throw Error(
        "{}: expected a capture or a bag, found {}; give a .pcap, .pcapng, .db3, .mcap or .bag "
        "file",
        path, fs::is_empty(path, error) ? "an empty file" : "a file that begins as neither");
  }
  if (form->open == nullptr) return open_pcap_recording(path);
  return std::make_unique<BagRecording>(std::move(files), form->kind, form->open,
                                        missing_files(path));
}

bool is_capture_or_bag(const std::string& path) {
  constexpr std::array kEndings = {".pcap", ".pcapng", ".db3", ".mcap", ".bag"};
  Paths files;
  std::error_code error;
  return form_of(path, files).has_value() ||
         (fs::is_regular_file(path, error) &&
          std::ranges::find(kEndings, fs::path(path).extension()) != kEndings.end());
}

}  // namespace hqslam::recordings

#include "streams/stream_reader.h"

#include <fmt/format.h>

#include <cmath>

#include "bags/message_packets.h"
#include "hqslam/core/error.h"
#include "packets/ouster_metadata.h"
#include "packets/robosense_decoder.h"

namespace hqslam::recordings {

namespace {

/// Sensors that are recorded together begin within this time.
constexpr double kListen_s = 2.0;

/// In a damaged file the times may have any value.
double seconds_apart(std::int64_t a_ns, std::int64_t b_ns) {
  return 1e-9 * std::abs(static_cast<double>(a_ns) - static_cast<double>(b_ns));
}

bool has_scans(const Stream& stream) {
  return stream.kind == StreamKind::kVelodynePackets || stream.kind == StreamKind::kHesaiPackets ||
         stream.kind == StreamKind::kRobosensePackets ||
         stream.kind == StreamKind::kOusterPackets || stream.kind == StreamKind::kPointClouds;
}

/// Whether later messages may show that it has scans.
bool may_have_scans(const Stream& stream) {
  return has_scans(stream) || carries_packets(stream.type);
}

bool is_named(const Stream& stream, const std::string& name) {
  return name.empty() || stream.name == name ||
         (stream.endpoint.port != 0 && std::to_string(stream.endpoint.port) == name);
}

bool is_static_transforms(const Stream& stream) {
  return stream.name.ends_with("/tf_static") && plain_type(stream.type).ends_with("/TFMessage");
}

std::string listed(const std::vector<Stream>& streams) {
  std::string text;
  for (const Stream& stream : streams) {
    text += fmt::format("{}{}", text.empty() ? "" : ", ", stream.name);
    if (text.size() > 500) return text + ", ...";
  }
  return text.empty() ? "none" : text;
}

}  // namespace

void add_metadata(const Stream& stream, const Message& message, std::vector<TopicText>& texts) {
  if (plain_type(stream.type) != "std_msgs/String") return;
  if (stream.name.find("metadata") == std::string::npos) return;
  if (message.bytes.size() > kMostMetadata_bytes || texts.size() == kMostMetadataTexts) return;
  try {
    std::string text = MessageReader(message).words();
    if (is_ouster_metadata(text)) texts.push_back({stream.name, std::move(text)});
  } catch (const Error&) {
    return;
  }
}

StreamReader::StreamReader(const std::string& path, const std::string& wanted)
    : path_(path), wanted_(wanted), file_(open_recording_file(path)) {
  listen();
  chosen_ = chosen();
  imu_ = imu_stream(file_->streams(), chosen_, transforms_);
  std::erase_if(kept_, [&](const Kept& kept) { return kept.message.stream != chosen_; });
  std::erase_if(kept_imu_, [&](const Kept& kept) { return kept.message.stream != imu_.stream; });
  kept_bytes_ = 0;
  for (const auto* kept : {&kept_, &kept_imu_}) {
    for (const Kept& one : *kept) kept_bytes_ += one.memory_bytes();
  }
}

Bytes StreamReader::settings() const {
  const auto found = settings_.find(stream().endpoint.address);
  return found == settings_.end() ? Bytes{} : Bytes(found->second);
}

void StreamReader::skip_others() {
  std::vector<std::size_t> streams = {chosen_};
  if (imu_.stream) streams.push_back(*imu_.stream);
  file_->keep_only(streams);
}

void StreamReader::listen() {
  std::optional<std::int64_t> begin_ns;
  while (const auto message = file_->next()) {
    const Stream& stream = file_->streams()[message->stream];
    add_metadata(stream, *message, metadata_);
    if (is_static_transforms(stream)) transforms_.add(*message);
    if (stream.type.empty() && is_settings(message->bytes)) {
      settings_.try_emplace(stream.endpoint.address, message->bytes.begin(), message->bytes.end());
    }
    const bool is_imu = stream.kind == StreamKind::kInertialData;
    if (!is_imu && !(is_named(stream, wanted_) && may_have_scans(stream))) continue;
    keep(*message, is_imu ? kept_imu_ : kept_);
    if (!begin_ns && has_scans(stream)) begin_ns = message->time_ns;
    const bool much = kept_bytes_ >= kMostKept_bytes;
    if (begin_ns && (much || seconds_apart(message->time_ns, *begin_ns) >= kListen_s)) break;
    if (!much) continue;
    kept_.clear();  // none of it was a scan's
    kept_imu_.clear();
    kept_bytes_ = 0;
  }
}

std::size_t StreamReader::chosen() const {
  const std::vector<Stream>& streams = file_->streams();
  std::vector<Stream> candidates;
  std::size_t last = 0;
  for (std::size_t i = 0; i < streams.size(); ++i) {
    if (!has_scans(streams[i]) || !is_named(streams[i], wanted_)) continue;
    candidates.push_back(streams[i]);
    last = i;
  }
  if (candidates.size() == 1) return last;
  for (const Stream& stream : streams) {
    if (!candidates.empty() || !stream.type.ends_with("/CustomMsg")) continue;
    throw Error(
        "{}: expected sensor_msgs/PointCloud2, found a Livox's {} in {}; record with xfer_format 0",
        path_, stream.type, stream.name);
  }
  if (candidates.empty() && !wanted_.empty()) {
    throw Error(
        "{}: expected scans in stream {}, found these streams: {}; name one of them that has scans",
        path_, wanted_, listed(streams));
  }
  if (candidates.empty()) {
    const std::string complaint = file_->complaint();
    throw Error(
        "{}: expected point clouds or packets of an Ouster, Velodyne, RoboSense, Hesai XT16 or "
        "XT32, found none in these streams: {}{}; record the point clouds of the sensor's driver",
        path_, listed(streams), complaint.empty() ? "" : " (" + complaint + ")");
  }
  throw Error("{}: has several streams with scans: {}; name one of them with --stream", path_,
              listed(candidates));
}

void StreamReader::keep(const Message& message, std::deque<Kept>& where) {
  Kept& kept = where.emplace_back();
  kept.bytes.assign(message.bytes.begin(), message.bytes.end());
  kept.message = message;
  kept.message.bytes = kept.bytes;
  kept.share = file_->read_share();
  kept.number = kept_messages_++;
  kept_bytes_ += kept.memory_bytes();
}

std::optional<Message> StreamReader::read(bool keeps_imu) {
  while (const auto message = file_->next()) {
    if (message->stream == chosen_) return message;
    if (message->stream != imu_.stream) continue;
    if (keeps_imu) {
      keep(*message, kept_imu_);
    } else {
      take_imu_(*message);
    }
  }
  return std::nullopt;
}

void StreamReader::give_kept_imu(std::int64_t before) {
  while (!kept_imu_.empty() && kept_imu_.front().number < before) {
    take_imu_(kept_imu_.front().message);
    kept_bytes_ -= kept_imu_.front().memory_bytes();
    kept_imu_.pop_front();
  }
}

std::optional<Message> StreamReader::ahead(std::size_t index) {
  while (kept_.size() <= index && kept_bytes_ < kMostKept_bytes) {
    const auto message = read(true);
    if (!message) break;
    keep(*message, kept_);
  }
  return index < kept_.size() ? std::optional(kept_[index].message) : std::nullopt;
}

std::optional<Message> StreamReader::next() {
  give_kept_imu(kept_.empty() ? kept_messages_ : kept_.front().number);
  if (kept_.empty()) {
    const auto message = read(false);
    share_ = message ? file_->read_share() : 1.0;
    return message;
  }
  current_ = std::move(kept_.front());
  kept_.pop_front();
  kept_bytes_ -= current_.memory_bytes();
  share_ = current_.share;
  return current_.message;
}

std::string StreamReader::passed_over() const {
  if (!wanted_.empty()) return "";
  std::vector<Stream> others;
  for (const Stream& stream : file_->streams()) {
    if (has_scans(stream) && stream.name != this->stream().name) others.push_back(stream);
  }
  if (others.empty()) return "";
  return fmt::format("{}: scans of {} are read; later ones of {} are not: name them with --stream",
                     path_, stream().name, listed(others));
}

}  // namespace hqslam::recordings

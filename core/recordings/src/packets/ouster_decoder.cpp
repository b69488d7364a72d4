#include "packets/ouster_decoder.h"

#include <fmt/format.h>

#include <algorithm>

#include "hqslam/core/angles.h"
#include "hqslam/core/error.h"

namespace hqslam::recordings {

namespace {

/// A packet of a frame this far back was overtaken; one of an older frame is of a sensor that
/// began to count anew.
constexpr std::int64_t kMostLateFrames = 16;
/// Turns up to this many were lost; more, and the sensor began to count anew.
constexpr std::int64_t kMostLostFrames = 6000;
constexpr double kMissingAtEnd = 0.1;

// The two are read 0.2 ms apart; turning needs its time more than pushing does.
constexpr std::size_t kGyroscopeTimeAt = 16;
constexpr std::size_t kAccelerationAt = 24;
constexpr std::size_t kAngularVelocityAt = 36;

Eigen::Vector3d vector_at(Bytes packet, std::size_t at) {
  return {little_endian<float>(packet, at), little_endian<float>(packet, at + 4),
          little_endian<float>(packet, at + 8)};
}

}  // namespace

ImuSample ouster_imu_sample(Bytes packet, const OusterMetadata& metadata) {
  ImuSample sample;
  sample.stamp_s =
      1e-9 * static_cast<double>(little_endian<std::uint64_t>(packet, kGyroscopeTimeAt));
  sample.angular_rate_rad_per_s =
      metadata.R_sensor_imu * (kDegree_rad * vector_at(packet, kAngularVelocityAt));
  sample.specific_force_mps2 =
      metadata.R_sensor_imu * (kGravity_mps2 * vector_at(packet, kAccelerationAt));
  return sample;
}

OusterDecoder::OusterDecoder(const OusterMetadata& metadata, const DecoderOptions& options,
                             std::string name)
    : metadata_(metadata),
      options_(options),
      layout_(layout(metadata.profile)),
      geometry_(metadata, options),
      name_(std::move(name)) {
  const int columns = metadata_.sensor.columns;
  first_sent_ = columns;
  for (int begin = 0; begin < columns; begin += metadata_.columns_per_packet) {
    bool sent = false;
    for (int i = begin; i < std::min(columns, begin + metadata_.columns_per_packet); ++i) {
      if (!metadata_.in_window(i)) continue;
      sent = true;
      first_sent_ = std::min(first_sent_, i);
      last_sent_ = i;
    }
    packets_sent_ += sent ? 1 : 0;
  }
}

void OusterDecoder::begin(const Packet& packet, std::uint32_t id) {
  const auto columns = static_cast<std::size_t>(metadata_.sensor.columns);
  const auto pixels = columns * static_cast<std::size_t>(metadata_.sensor.rows());
  OusterFrame frame;
  frame.frame_id = id;
  if (options_.with_points) {
    frame.range_mm.assign(pixels, 0);
    frame.reflectivity.assign(pixels, 0);
    if (metadata_.dual_return()) {
      frame.second_range_mm.assign(pixels, 0);
      frame.second_reflectivity.assign(pixels, 0);
    }
  }
  frame.timestamp_ns.assign(columns, 0);
  frame.status.assign(columns, 0);
  frame.first_capture_ns = packet.capture_time_ns;
  const auto first = first_column(packet.payload);
  frame.first_timestamp_ns = little_endian<std::uint64_t>(
      first ? first->bytes : packet.payload.data() + layout_.packet_header);
  frame_ = std::move(frame);
  last_id_ = id;
  packets_in_frame_ = 0;
}

std::optional<OusterDecoder::Column> OusterDecoder::column(Bytes packet, int place) const {
  Column result;
  result.bytes =
      packet.data() + layout_.packet_header + column_bytes() * static_cast<std::size_t>(place);
  result.id = little_endian<std::uint16_t>(result.bytes + 8);
  const bool legacy = layout_.column_footer > 0;
  result.status =
      legacy ? little_endian<std::uint32_t>(result.bytes + column_bytes() - layout_.column_footer)
             : little_endian<std::uint16_t>(result.bytes + 10);
  const auto columns = static_cast<std::size_t>(metadata_.sensor.columns);
  if ((result.status & 1U) == 0 || result.id >= columns) return std::nullopt;
  return result;
}

/// The first valid one.
std::optional<OusterDecoder::Column> OusterDecoder::first_column(Bytes packet) const {
  for (int place = 0; place < metadata_.columns_per_packet; ++place) {
    if (const auto found = column(packet, place)) return found;
  }
  return std::nullopt;
}

void OusterDecoder::add(const Packet& packet) {
  if (packet.payload.size() != kOusterImuBytes) return add_lidar(packet);
  imu_.add(ouster_imu_sample(packet.payload, metadata_));
}

void OusterDecoder::add_lidar(const Packet& packet) {
  if (packet.payload.size() != metadata_.packet_bytes()) {
    ++counts_.foreign;
    return;
  }
  const std::uint64_t serial = serial_number(packet.payload, metadata_.profile);
  if (options_.serial_number != 0 && serial != 0 && serial != options_.serial_number) {
    ++counts_.foreign;
    return;
  }
  const std::uint32_t id = frame_id(packet.payload, metadata_.profile);
  if (last_id_ && id != *last_id_) {
    const std::int64_t ahead = metadata_.profile == OusterProfile::kFusaDual
                                   ? static_cast<std::int32_t>(id - *last_id_)
                                   : static_cast<std::int16_t>(id - *last_id_);
    if (ahead < 0 && ahead >= -kMostLateFrames) {
      ++counts_.late;
      return;
    }
    complete(false);
    if (ahead > 1 && ahead <= kMostLostFrames) lost_scans_ += ahead - 1;
  } else if (last_id_ && (!frame_ || seen(packet.payload))) {
    ++counts_.late;  // of a frame that has it, or all of its packets
    return;
  }
  if (!frame_) begin(packet, id);
  ++counts_.used;
  ++packets_in_frame_;
  read_columns(packet.payload);
  // A live sensor's scan need not wait for the first packet of the next turn.
  if (packets_in_frame_ == packets_sent_) complete(false);
}

void OusterDecoder::read_columns(Bytes packet) {
  for (int place = 0; place < metadata_.columns_per_packet; ++place) {
    const auto found = column(packet, place);
    if (!found) continue;
    frame_->timestamp_ns[found->id] = little_endian<std::uint64_t>(found->bytes);
    frame_->status[found->id] = found->status;
    if (!options_.with_points) continue;
    read_pixels(found->bytes + layout_.column_header, static_cast<int>(found->id));
  }
}

void OusterDecoder::read_pixels(const std::uint8_t* pixels, int column) {
  const auto columns = static_cast<std::size_t>(metadata_.sensor.columns);
  const auto read = [&](const std::uint8_t* begin, std::vector<std::uint32_t>& range,
                        std::vector<std::uint16_t>& bright) {
    auto i = static_cast<std::size_t>(column);
    for (const std::size_t pixel : metadata_.pixel_of_row) {
      const std::uint8_t* at = begin + layout_.pixel * pixel;
      range[i] = range_mm(at, layout_);
      bright[i] = reflectivity(at, layout_);
      i += columns;
    }
  };
  read(pixels, frame_->range_mm, frame_->reflectivity);
  if (layout_.second_range_at == 0) return;
  read(pixels + layout_.second_range_at, frame_->second_range_mm, frame_->second_reflectivity);
}

/// Ends the frame. Of the first and the last one of a recording a part may never have been
/// recorded; such a frame is left out, unless it is the only one.
void OusterDecoder::complete(bool at_end) {
  if (!frame_) return;
  const auto& status = frame_->status;
  const auto valid = [](std::uint32_t s) { return s != 0; };
  const auto first = std::ranges::find_if(status, valid) - status.begin();
  const auto last = status.rend() - std::find_if(status.rbegin(), status.rend(), valid) - 1;
  const double most = kMissingAtEnd * metadata_.sensor.columns;
  const bool begins_late = first_frame_ && static_cast<double>(first - first_sent_) > most;
  const bool ends_early = at_end && static_cast<double>(last_sent_ - last) > most;
  if ((first_frame_ && at_end) || !(begins_late || ends_early)) {
    counts_.lost += std::max<std::int64_t>(0, packets_sent_ - packets_in_frame_);
    completed_.push_back(std::move(*frame_));
  } else {
    ++partial_scans_;
  }
  first_frame_ = false;
  frame_.reset();
}

std::optional<RecordedScan> OusterDecoder::next() {
  if (completed_.empty()) return std::nullopt;
  OusterFrame frame = std::move(completed_.front());
  completed_.erase(completed_.begin());
  RecordedScan result;
  result.name = fmt::format("{}[{}]", name_, taken_++);
  std::optional<OusterScan> scan = geometry_.scan(frame);
  if (!scan) {
    throw ScanError(
        "{}: expected columns of one turn, found times of more than a second or none; the "
        "packets are damaged",
        result.name);
  }
  result.stamp_s = scan->stamp_s;
  result.imu = imu_.take(scan->sensor_stamp_s + 0.5 * metadata_.sensor.scan_period_s,
                         scan->stamp_s - scan->sensor_stamp_s);
  result.cloud = std::move(scan->cloud);
  for (const float range_m : result.cloud.range_m) result.counts.kept += range_m > 0.0F ? 1 : 0;
  std::int64_t returns = 0;
  for (std::size_t i = 0; i < frame.range_mm.size(); ++i) {
    const bool second = !frame.second_range_mm.empty() && frame.second_range_mm[i] > 0;
    returns += frame.range_mm[i] > 0 || second ? 1 : 0;
  }
  result.counts.out_of_range = returns - result.counts.kept;
  return result;
}

}  // namespace hqslam::recordings

#include <algorithm>

#include "ouster_layout.h"

namespace hqslam::recordings {

namespace {

/// A packet of a frame this far back was overtaken; one of an older frame is of a sensor that
/// began to count anew.
constexpr std::int64_t kMostLateFrames = 16;
/// Turns up to this many were lost; more, and the sensor began to count anew.
constexpr std::int64_t kMostLostFrames = 6000;
constexpr double kMissingAtEnd = 0.1;

}  // namespace

class OusterDecoder::Impl {
 public:
  Impl(const OusterMetadata& metadata, const OusterOptions& options)
      : metadata_(metadata), options_(options), layout_(layout(metadata.profile)) {
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

  void add(const Packet& packet, std::vector<OusterFrame>& completed);
  void complete(std::vector<OusterFrame>& completed, bool at_end);

  PacketCounts counts;
  std::int64_t lost_frames = 0;
  std::int64_t partial_frames = 0;

 private:
  void begin(const Packet& packet, std::uint32_t id);
  void read_columns(Bytes packet);
  void read_pixels(const std::uint8_t* pixels, int column);
  /// A column of a packet: where it begins, which one it is of the turn, its status.
  struct Column {
    const std::uint8_t* bytes = nullptr;
    std::size_t id = 0;
    std::uint32_t status = 0;
  };
  /// Nothing if the sensor says that the column is not valid.
  std::optional<Column> column(Bytes packet, int place) const;
  std::optional<Column> first_column(Bytes packet) const;
  /// Whether the first valid column of the packet has come already.
  bool seen(Bytes packet) const {
    const auto first = first_column(packet);
    return first && frame_->status[first->id] != 0;
  }
  std::size_t column_bytes() const {
    return layout_.column_header + layout_.column_footer +
           layout_.pixel * static_cast<std::size_t>(metadata_.sensor.rows());
  }

  OusterMetadata metadata_;
  OusterOptions options_;
  OusterLayout layout_;
  std::optional<OusterFrame> frame_;
  std::optional<std::uint32_t> last_id_;  ///< of the frame that is read or was read last
  bool first_frame_ = true;
  std::int64_t packets_in_frame_ = 0;
  /// What the sensor sends of a turn.
  int first_sent_ = 0;
  int last_sent_ = 0;
  std::int64_t packets_sent_ = 0;
};

void OusterDecoder::Impl::begin(const Packet& packet, std::uint32_t id) {
  const auto columns = static_cast<std::size_t>(metadata_.sensor.columns);
  const auto pixels = columns * static_cast<std::size_t>(metadata_.sensor.rows());
  OusterFrame frame;
  frame.frame_id = id;
  if (options_.with_ranges) {
    frame.range_mm.assign(pixels, 0);
    if (metadata_.dual_return()) frame.second_range_mm.assign(pixels, 0);
  }
  frame.timestamp_ns.assign(columns, 0);
  frame.measurement_id.assign(columns, 0);
  frame.status.assign(columns, 0);
  frame.first_capture_ns = packet.capture_time_ns;
  const auto first = first_column(packet.payload);
  frame.first_timestamp_ns = little_endian<std::uint64_t>(
      first ? first->bytes : packet.payload.data() + layout_.packet_header);
  frame_ = std::move(frame);
  last_id_ = id;
  packets_in_frame_ = 0;
}

std::optional<OusterDecoder::Impl::Column> OusterDecoder::Impl::column(Bytes packet,
                                                                       int place) const {
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
std::optional<OusterDecoder::Impl::Column> OusterDecoder::Impl::first_column(Bytes packet) const {
  for (int place = 0; place < metadata_.columns_per_packet; ++place) {
    if (const auto found = column(packet, place)) return found;
  }
  return std::nullopt;
}

void OusterDecoder::Impl::add(const Packet& packet, std::vector<OusterFrame>& completed) {
  if (packet.payload.size() != metadata_.packet_bytes()) {
    ++counts.foreign;
    return;
  }
  const std::uint64_t serial = serial_number(packet.payload, metadata_.profile);
  if (options_.serial_number != 0 && serial != 0 && serial != options_.serial_number) {
    ++counts.foreign;
    return;
  }
  const std::uint32_t id = frame_id(packet.payload, metadata_.profile);
  if (last_id_ && id != *last_id_) {
    const std::int64_t ahead = metadata_.profile == OusterProfile::kFusaDual
                                   ? static_cast<std::int32_t>(id - *last_id_)
                                   : static_cast<std::int16_t>(id - *last_id_);
    if (ahead < 0 && ahead >= -kMostLateFrames) {
      ++counts.late;
      return;
    }
    complete(completed, false);
    if (ahead > 1 && ahead <= kMostLostFrames) lost_frames += ahead - 1;
  } else if (last_id_ && (!frame_ || seen(packet.payload))) {
    ++counts.late;  // of a frame that has it, or all of its packets
    return;
  }
  if (!frame_) begin(packet, id);
  ++counts.used;
  ++packets_in_frame_;
  read_columns(packet.payload);
  // Whoever follows a sensor need not wait for the first packet of the next turn.
  if (packets_in_frame_ == packets_sent_) complete(completed, false);
}

void OusterDecoder::Impl::read_columns(Bytes packet) {
  for (int place = 0; place < metadata_.columns_per_packet; ++place) {
    const auto found = column(packet, place);
    if (!found) continue;
    frame_->timestamp_ns[found->id] = little_endian<std::uint64_t>(found->bytes);
    frame_->measurement_id[found->id] = static_cast<std::uint16_t>(found->id);
    frame_->status[found->id] = found->status;
    if (!options_.with_ranges) continue;
    read_pixels(found->bytes + layout_.column_header, static_cast<int>(found->id));
  }
}

void OusterDecoder::Impl::read_pixels(const std::uint8_t* pixels, int column) {
  const auto columns = static_cast<std::size_t>(metadata_.sensor.columns);
  const auto rows = static_cast<std::size_t>(metadata_.sensor.rows());
  std::uint32_t* range = frame_->range_mm.data() + column;
  for (std::size_t row = 0; row < rows; ++row) {
    range[row * columns] = range_mm(pixels + row * layout_.pixel, layout_);
  }
  if (layout_.second_range_at == 0) return;
  std::uint32_t* second = frame_->second_range_mm.data() + column;
  for (std::size_t row = 0; row < rows; ++row) {
    second[row * columns] =
        range_mm(pixels + row * layout_.pixel + layout_.second_range_at, layout_);
  }
}

/// Ends the frame. Of the first and the last one of a recording a part may never have been
/// recorded; such a frame is left out, unless it is the only one.
void OusterDecoder::Impl::complete(std::vector<OusterFrame>& completed, bool at_end) {
  if (!frame_) return;
  const auto& status = frame_->status;
  const auto valid = [](std::uint32_t s) { return s != 0; };
  const auto first = std::find_if(status.begin(), status.end(), valid) - status.begin();
  const auto last = status.rend() - std::find_if(status.rbegin(), status.rend(), valid) - 1;
  const double most = kMissingAtEnd * metadata_.sensor.columns;
  const bool begins_late = first_frame_ && static_cast<double>(first - first_sent_) > most;
  const bool ends_early = at_end && static_cast<double>(last_sent_ - last) > most;
  if ((first_frame_ && at_end) || !(begins_late || ends_early)) {
    counts.lost += std::max<std::int64_t>(0, packets_sent_ - packets_in_frame_);
    completed.push_back(std::move(*frame_));
  } else {
    ++partial_frames;
  }
  first_frame_ = false;
  frame_.reset();
}

OusterDecoder::OusterDecoder(const OusterMetadata& metadata, const OusterOptions& options)
    : impl_(std::make_unique<Impl>(metadata, options)) {}
OusterDecoder::~OusterDecoder() = default;
OusterDecoder::OusterDecoder(OusterDecoder&&) noexcept = default;

void OusterDecoder::add(const Packet& packet, std::vector<OusterFrame>& completed) {
  impl_->add(packet, completed);
}
void OusterDecoder::finish(std::vector<OusterFrame>& completed) {
  impl_->complete(completed, true);
}
const PacketCounts& OusterDecoder::counts() const { return impl_->counts; }
std::int64_t OusterDecoder::lost_frames() const { return impl_->lost_frames; }
std::int64_t OusterDecoder::partial_frames() const { return impl_->partial_frames; }

}  // namespace hqslam::recordings

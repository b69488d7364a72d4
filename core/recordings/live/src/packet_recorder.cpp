#include "packet_recorder.h"

#include "hqslam/core/error.h"

namespace hqslam::live {

using namespace recordings;

namespace {

constexpr std::size_t kMostKept_bytes = std::size_t{64} << 20U;

}  // namespace

PacketRecorder::PacketRecorder(const std::string& path) {
  if (!path.empty()) writer_.emplace(path);
}

template <typename Write>
void PacketRecorder::record(const Write& write) {
  if (!writer_) return;
  try {
    write(*writer_);
  } catch (const Error& error) {
    writer_.reset();
    failure_ = error.what();
  }
}

void PacketRecorder::add(const Packet& packet) {
  record([&](PcapWriter& writer) { writer.add(packet); });
}

void PacketRecorder::keep(const Packet& packet) {
  if (!writer_) return;
  kept_.push_back({packet, {packet.payload.begin(), packet.payload.end()}});
  kept_bytes_ += packet.payload.size();
  while (kept_bytes_ > kMostKept_bytes) {
    kept_bytes_ -= kept_.front().payload.size();
    kept_.pop_front();
  }
}

void PacketRecorder::begin(const LiveStream& stream) {
  if (!stream.metadata_text().empty()) {
    record([&](const PcapWriter& writer) { writer.put_beside(stream.metadata_text()); });
  }
  for (Kept& kept : kept_) {
    kept.packet.payload = kept.payload;
    if (kept.packet.endpoint == stream.sender()) add(kept.packet);
  }
  kept_.clear();
}

}  // namespace hqslam::live

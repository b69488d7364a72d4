#include "hqslam/live/live.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>

#include "hqslam/core/error.h"
#include "live_stream.h"
#include "packet_recorder.h"
#include "udp_socket.h"

namespace hqslam::live {

using namespace recordings;

namespace {

using Clock = std::chrono::steady_clock;

/// How long the thread waits for a packet before it looks whether it is to end.
constexpr int kWait_ms = 50;
/// Packets of inertial data between two others; a flood of them must not hold up the scans.
constexpr int kMostImuAtOnce = 100;
/// Inertial samples of dropped scans that the next one carries.
constexpr std::size_t kMostImuSamples = 20'000;
/// After this time without a packet that can be decoded, counts() reports trouble.
constexpr std::chrono::nanoseconds kTrouble = std::chrono::seconds(2);

const LiveOptions& checked(const LiveOptions& options) {
  if (options.most_waiting < 1) {
    throw Error("most_waiting is {}, expected 1 or more complete scans that may wait",
                options.most_waiting);
  }
  return options;
}

}  // namespace

class LiveSensor::Impl {
 public:
  explicit Impl(const LiveOptions& options)
      : options_(checked(options)),
        stream_(options),
        socket_(options.port != 0 ? options.port : stream_.usual_port()),
        recorder_(options_.record) {}
  ~Impl() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  bool recognize(double timeout_s);
  void start(int columns);
  std::optional<LiveScan> next(double timeout_s);

  std::uint16_t port() const { return socket_.port(); }
  std::int64_t packets_seen() const { return seen_; }
  const LiveStream& stream() const { return stream_; }
  Endpoint sender() const {
    if (!thread_.joinable()) return stream_.sender();
    const std::lock_guard lock(mutex_);
    return sender_;
  }
  LiveCounts counts() const {
    const std::lock_guard lock(mutex_);
    return counts_;
  }

 private:
  bool is_sensors(const Packet& packet);
  void judge(std::int64_t arrival_ns);
  void judge_silence();
  void listen_for_imu();
  void take_imu();
  void run();
  void take_scans(std::int64_t arrival_ns);
  void drop_oldest();

  LiveOptions options_;
  LiveStream stream_;
  UdpSocket socket_;
  std::optional<UdpSocket> imu_socket_;  ///< of an Ouster
  PacketRecorder recorder_;
  std::int64_t seen_ = 0;
  bool recognized_ = false;
  Clock::time_point heard_;  ///< when the sensor's last packet came
  Packet first_;             ///< that is decoded: the one by which the sensor was recognized
  std::vector<std::uint8_t> first_payload_;

  std::unique_ptr<ScanAssembler> assembler_;
  std::thread thread_;
  std::atomic<bool> stop_ = false;
  mutable std::mutex mutex_;  ///< of what follows
  std::condition_variable arrived_;
  std::deque<LiveScan> waiting_;
  LiveCounts counts_;
  Endpoint sender_;
  std::int64_t understood_ = 0;     ///< packets
  std::int64_t understood_ns_ = 0;  ///< when the last of them came
  std::exception_ptr failure_;
};

bool LiveSensor::Impl::recognize(double timeout_s) {
  const auto end = Clock::now() + std::chrono::duration<double>(timeout_s);
  while (!recognized_) {
    const auto left_ms = std::chrono::duration<double, std::milli>(end - Clock::now()).count();
    if (left_ms <= 0.0) return false;
    const auto packet =
        socket_.receive(static_cast<int>(std::clamp(left_ms, 1.0, double{kWait_ms})));
    if (!packet) continue;
    ++seen_;
    recorder_.keep(*packet);
    recognized_ = stream_.recognize(*packet);
    if (!recognized_) continue;
    first_ = *packet;
    first_payload_.assign(packet->payload.begin(), packet->payload.end());
    first_.payload = first_payload_;
    recorder_.begin(stream_);
    counts_.recording_failure = recorder_.failure();
  }
  return true;
}

void LiveSensor::Impl::start(int columns) {
  if (thread_.joinable()) {
    throw Error("the sensor was started already, expected start() once; make another LiveSensor");
  }
  assembler_ = stream_.assembler(columns);
  assembler_->add(first_);
  sender_ = stream_.sender();
  understood_ns_ = first_.capture_time_ns;
  heard_ = Clock::now();
  listen_for_imu();
  thread_ = std::thread([this] { run(); });
}

/// If the port is in use, the drive continues without inertial data.
void LiveSensor::Impl::listen_for_imu() {
  const std::uint16_t port = stream_.imu_port();
  if (port == 0 || port == socket_.port()) return;
  try {
    imu_socket_.emplace(port);
  } catch (const Error& error) {
    counts_.imu_failure = error.what();
  }
}

/// What has come of inertial data up to now, so that it is there before its scan is complete.
void LiveSensor::Impl::take_imu() {
  for (int i = 0; imu_socket_ && i < kMostImuAtOnce; ++i) {
    const std::optional<Packet> packet = imu_socket_->receive(0);
    if (!packet) return;
    if (!stream_.is_imu(*packet)) continue;
    recorder_.add(*packet);
    assembler_->add(*packet);
  }
}

void LiveSensor::Impl::run() {
  try {
    while (!stop_) {
      const std::optional<Packet> packet = socket_.receive(kWait_ms);
      if (!packet || !is_sensors(*packet)) {
        judge_silence();
        continue;
      }
      heard_ = Clock::now();
      take_imu();
      recorder_.add(*packet);
      assembler_->add(*packet);
      take_scans(packet->capture_time_ns);
    }
  } catch (...) {
    const std::lock_guard lock(mutex_);
    failure_ = std::current_exception();
    arrived_.notify_one();
  }
}

bool LiveSensor::Impl::is_sensors(const Packet& packet) {
  const Endpoint before = stream_.sender();
  const bool is_sensors = stream_.is_sensors(packet);
  const std::lock_guard lock(mutex_);
  counts_.other_senders += is_sensors ? 0 : 1;
  counts_.senders_changed += stream_.sender() != before ? 1 : 0;
  sender_ = stream_.sender();
  return is_sensors;
}

/// Reports packets of the sensor in another form than expected: its mode was changed.
void LiveSensor::Impl::judge(std::int64_t arrival_ns) {
  const PacketCounts& packets = counts_.packets;
  if (packets.used + packets.late != understood_) {
    understood_ = packets.used + packets.late;
    understood_ns_ = arrival_ns;
    counts_.trouble.clear();
  } else if (arrival_ns - understood_ns_ > kTrouble.count()) {
    counts_.trouble =
        "the sensor sends packets of another form than at first: set its mode back, or start again";
  }
}

void LiveSensor::Impl::judge_silence() {
  if (Clock::now() - heard_ < kTrouble) return;
  const std::lock_guard lock(mutex_);
  counts_.trouble = "no more packets from the sensor: check its power, cable and settings";
}

/// The inertial samples of a dropped scan go to the next one.
void LiveSensor::Impl::drop_oldest() {
  std::vector<ImuSample> samples = std::move(waiting_.front().scan.imu);
  waiting_.pop_front();
  ++counts_.dropped_scans;
  std::vector<ImuSample>& next = waiting_.front().scan.imu;
  samples.insert(samples.end(), next.begin(), next.end());
  if (samples.size() > kMostImuSamples)
    samples.erase(samples.begin(), samples.end() - kMostImuSamples);
  next = std::move(samples);
}

/// Puts what the last packet completed in line.
void LiveSensor::Impl::take_scans(std::int64_t arrival_ns) {
  while (true) {
    std::optional<RecordedScan> scan;
    std::string left_out;
    try {
      scan = assembler_->next();
    } catch (const ScanError& error) {
      left_out = error.what();
    }
    const std::lock_guard lock(mutex_);
    counts_.recording_failure = recorder_.failure();
    counts_.packets = assembler_->counts();
    counts_.imu = assembler_->imu_counts();
    counts_.lost_scans = assembler_->lost_scans();
    judge(arrival_ns);
    if (!scan && left_out.empty()) return;
    ++counts_.scans;
    if (!scan) {
      if (counts_.left_out_scans++ == 0) counts_.first_left_out = left_out;
      continue;
    }
    waiting_.push_back({std::move(*scan), arrival_ns});
    if (waiting_.size() > static_cast<std::size_t>(options_.most_waiting)) drop_oldest();
    arrived_.notify_one();
  }
}

std::optional<LiveScan> LiveSensor::Impl::next(double timeout_s) {
  std::unique_lock lock(mutex_);
  arrived_.wait_for(lock, std::chrono::duration<double>(timeout_s),
                    [this] { return !waiting_.empty() || failure_; });
  if (!waiting_.empty()) {
    LiveScan scan = std::move(waiting_.front());
    waiting_.pop_front();
    return scan;
  }
  if (failure_) std::rethrow_exception(failure_);
  return std::nullopt;
}

NamedSensor named_sensor(const std::string& sensor) {
  return LiveStream({.sensor = sensor}).named();
}

LiveSensor::LiveSensor(const LiveOptions& options) : impl_(std::make_unique<Impl>(options)) {}
LiveSensor::~LiveSensor() = default;
std::uint16_t LiveSensor::port() const { return impl_->port(); }
bool LiveSensor::recognize(double timeout_s) { return impl_->recognize(timeout_s); }
std::int64_t LiveSensor::packets_seen() const { return impl_->packets_seen(); }
std::string LiveSensor::complaint() const { return impl_->stream().complaint(); }
const SensorModel& LiveSensor::sensor() const { return impl_->stream().sensor(); }
Endpoint LiveSensor::sender() const { return impl_->sender(); }
std::string LiveSensor::format() const { return impl_->stream().format(); }
const std::vector<std::string>& LiveSensor::warnings() const { return impl_->stream().warnings(); }
void LiveSensor::start(int columns) { impl_->start(columns); }
std::optional<LiveScan> LiveSensor::next(double timeout_s) { return impl_->next(timeout_s); }
LiveCounts LiveSensor::counts() const { return impl_->counts(); }

}  // namespace hqslam::live

#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "byte_reader.h"
#include "hqslam/core/scan.h"
#include "hqslam/recordings/velodyne.h"
#include "packets/sensor_clock.h"
#include "scan_assembler.h"

namespace hqslam::recordings {

inline constexpr int kTurn = 36000;  ///< of a head, hundredths of a degree
inline int modulo_turn(int azimuth) { return (azimuth % kTurn + kTurn) % kTurn; }

struct PulseReturn {
  std::uint16_t distance = 0;  ///< in the sensor's unit; 0: none
  std::uint8_t reflectivity = 0;
};
/// The one of two returns of a pulse that is kept; sensors can send them in either order.
PulseReturn kept_of(PulseReturn a, PulseReturn b, KeptReturn which);

/// Nanoseconds since 1970 of a year and month, day, hour, minute, second, a byte each; nothing for
/// what is no date.
std::optional<std::int64_t> date_ns(int year, Bytes month_to_second);

/// Seconds a turn; 0.1 for what no head turns at.
double period_at(int turns_per_minute);

/// What the decoders of a head that turns clockwise share: its firings -> scans, one a turn, cut at
/// an azimuth.
///
/// What began in the middle of a turn is a scan only if it has three quarters of the field of view.
/// A scan's stamp is the middle between its first and its last firing.
class TurnDecoder : public ScanAssembler {
 public:
  const SensorModel& sensor() const override { return sensor_; }
  /// Nothing follows, or much later: what is left becomes a scan if it is nearly one.
  void finish() override;
  std::optional<RecordedScan> next() override;
  /// The scans that are complete, as points.
  std::vector<Scan> take_scans() { return std::exchange(completed_, {}); }
  const PacketCounts& counts() const override { return counts_; }
  std::int64_t lost_scans() const override { return lost_scans_; }
  std::int64_t partial_scans() const override { return partial_scans_; }

 protected:
  TurnDecoder(const SensorModel& sensor, std::string name, int cut, double field_of_view_deg,
              const DecoderOptions& options)
      : sensor_(sensor),
        options_(options),
        cut_(cut),
        field_of_view_deg_(field_of_view_deg),
        name_(std::move(name)) {}

  /// A packet has this time by the sensor's clock, and its first firing this azimuth: false if it
  /// is left out, as late. Where nothing came for a turn, or that clock was set back, the scan
  /// ends.
  bool take_time(std::int64_t sensor_ns, std::int64_t capture_ns, double scan_period_s,
                 int azimuth);
  /// The time of a packet by the clock of stamps. Where the recorder's clock was set, the scan
  /// ends.
  std::int64_t recorded_ns(std::int64_t sensor_ns, std::int64_t capture_ns);
  /// The head fires here, at this time by the clock of stamps: what is before the cut is a scan.
  /// The time since the first firing of the turn, which this one may be, seconds.
  double fire(int azimuth, std::int64_t time_ns);

  SensorModel sensor_;
  DecoderOptions options_;
  int cut_;
  double field_of_view_deg_;
  Scan scan_;                         ///< the turn that was begun; times since its first firing
  std::int64_t last_capture_ns_ = 0;  ///< of the packet before
  /// Between the last packet and the one before; 0 for the first one and where a clock was set.
  double passed_s_ = 0.0;
  std::int64_t cuts_ = 0;  ///< how often the head passed the cut in that time
  PacketCounts counts_;
  std::int64_t lost_scans_ = 0;

 private:
  void complete();

  std::string name_;  ///< of the scans, with their numbers
  std::vector<Scan> completed_;
  std::int64_t taken_ = 0;
  Scan spare_;  ///< empty, with memory
  SensorClock clock_;
  std::optional<std::int64_t> last_sensor_ns_;
  int last_packet_turned_ = 0;
  bool began_with_cut_ = false;
  bool empty_ = true;
  int first_turned_ = 0;
  int last_turned_ = 0;
  std::int64_t first_ns_ = 0;
  std::int64_t last_ns_ = 0;
  std::int64_t partial_scans_ = 0;
};

}  // namespace hqslam::recordings

#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "packets/turn_decoder.h"
#include "packets/velodyne_tables.h"

namespace hqslam::recordings {

/// Velodyne packets -> scans.
///
/// A scan is one turn of the head, cut at stream.cut_azimuth_deg, and where nothing came for a
/// turn; what is before the first cut, behind the last one or beside such a gap is a scan only if
/// it has three quarters of the field of view. A point's row is that of its laser, its time the
/// time of its firing by the sensor's clock, set by the time of recording; a scan's stamp is the
/// middle between its first and its last firing. Azimuths are interpolated between the blocks of a
/// packet. All beams start at the centre of the sensor (the lasers' heights above one another, up
/// to 11 mm, are left out). Pulses without return are no points; points of a range that the sensor
/// cannot measure are the projection's to drop. Sources: the models' user manuals (VLP-16 63-9243,
/// HDL-32E 63-9113, VLP-32C 63-9325, VLS-128 63-9483), "Data packet format" and "Firing sequence
/// timing".
class VelodyneDecoder : public TurnDecoder {
 public:
  /// `sensor` gives elevation and azimuth offset of each row; as many rows as the model has lasers.
  /// Throws Error if it has not.
  VelodyneDecoder(const VelodyneStream& stream, const SensorModel& sensor,
                  const DecoderOptions& options = {}, std::string name = "");

  void add(const Packet& packet) override;

 private:
  /// One firing of 32 channels (or the 16 of a VLP-16, twice).
  struct Firing {
    int block = 0;  ///< of the packet; with two returns the first of the pair
    int bank = 0;
    int azimuth = 0;
    double time_us = 0.0;  ///< after the time of the packet
    double rate = 0.0;     ///< hundredths of a degree in a microsecond
  };
  std::int64_t continued_us(const Packet& packet) const;
  void count_lost();
  void read_firings(Bytes payload);
  void set_rates();
  void add_points(const Firing& firing, Bytes payload, double start_s);
  double expected_rate() const { return kTurn / (1e6 * stream_.scan_period_s); }

  VelodyneStream stream_;
  VelodyneTiming timing_;
  VelodyneChannels channels_;
  std::optional<std::int64_t> sensor_us_;  ///< of the packet before, counted on over the hours
  double rate_ = 0.0;
  std::vector<Firing> firings_;
};

/// The sensor of a stream of packets, whose model is changed to the user's.
/// wanted_sensor: a preset's name or a .json file; empty: that of the stream. columns: of the
/// images; 0: the preset's, by the rate of turning. path: stands for the recording in messages.
/// Throws Error.
SensorModel velodyne_sensor(VelodyneStream& stream, const std::string& wanted_sensor, int columns,
                            const std::string& path, std::vector<std::string>& warnings);

/// The model of the sensor that a user names, if the name determines it. Throws Error for one that
/// is not there.
std::optional<VelodyneModel> named_model(const std::string& wanted_sensor);

}  // namespace hqslam::recordings

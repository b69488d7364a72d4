#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <sstream>
#include <utility>

#include "hqslam/core/angles.h"
#include "hqslam/core/error.h"
#include "hqslam/core/excerpt.h"
#include "hqslam/core/whole_file.h"
#include "packets/hesai_decoder.h"
#include "streams/stream_scans.h"

namespace hqslam::recordings {

namespace {

constexpr const char* kAnglesExtension = ".csv";
constexpr std::size_t kMostBytes = 100'000;
/// No laser looks farther aside.
constexpr double kMostAside_deg = 20.0;

SensorModel empty_sensor(std::string name, double scan_period_s) {
  SensorModel sensor;
  sensor.name = std::move(name);
  sensor.scan_period_s = scan_period_s;
  sensor.columns = 2000;  // 0.18 degrees at 10 turns a second
  sensor.min_range_m = 0.3;
  sensor.max_range_m = 120.0;
  return sensor;
}

std::string name_of(int lasers) { return fmt::format("xt{}", lasers); }

/// The angle file beside a recording: its name with .csv or _angles.csv; "" if there is none.
std::string angles_beside(const std::string& path) {
  const std::filesystem::path stem = std::filesystem::path(path).replace_extension();
  for (const char* ending : {"_angles.csv", kAnglesExtension}) {
    std::error_code error;
    const std::string beside = stem.string() + ending;
    if (std::filesystem::is_regular_file(beside, error)) return beside;
  }
  return "";
}

SensorModel sensor_of(const HesaiPacket& header, const OpenOptions& options,
                      const std::string& path, std::vector<std::string>& warnings) {
  const std::string wanted = options.sensor.empty() ? angles_beside(path) : options.sensor;
  SensorModel sensor;
  if (wanted.empty()) {
    sensor = nominal_hesai(header.lasers, header.scan_period_s);
    warnings.push_back(fmt::format(
        "{}: no angle file of this unit beside it; read with the manual's angles, which may be "
        "tenths of a degree off. Name the unit's .csv as the sensor",
        path));
  } else {
    sensor = wanted.ends_with(kAnglesExtension) ? read_hesai_angles(wanted, header.scan_period_s)
                                                : load_sensor(wanted);
  }
  if (sensor.rows() != header.lasers) {
    throw Error(
        "{}: expected a sensor of {} rows for packets of an {}, found '{}' with {}; name "
        "the angle file of the sensor that recorded them",
        path, header.lasers, name_of(header.lasers), sensor.name, sensor.rows());
  }
  warn_of_other_beams(sensor, nominal_hesai(header.lasers), path, warnings);
  sensor.scan_period_s = header.scan_period_s;
  set_columns(sensor, options.columns, !wanted.ends_with(".json"));
  validate(sensor);
  return sensor;
}

}  // namespace

double hesai_half_firing_rad(double scan_period_s) {
  constexpr double kFiringAtTenTurns_deg = 0.18;
  return 0.5 * kFiringAtTenTurns_deg * kDegree_rad * scan_period_s / 0.1;
}

SensorModel nominal_hesai(int lasers, double scan_period_s) {
  SensorModel sensor = empty_sensor(name_of(lasers), scan_period_s);
  for (int i = 0; i < lasers; ++i) {
    sensor.beam_elevation_rad.push_back((15.0 - i * (32.0 / lasers)) * kDegree_rad);
  }
  sensor.beam_azimuth_offset_rad.assign(sensor.beam_elevation_rad.size(),
                                        hesai_half_firing_rad(scan_period_s));
  return sensor;
}

SensorModel read_hesai_angles(const std::string& path, double scan_period_s) {
  std::istringstream lines(whole_file(path, "a Hesai angle file", kMostBytes));
  SensorModel sensor = empty_sensor("", scan_period_s);
  const auto complain = [&](const std::string& found) {
    throw Error(
        "{}: expected a Hesai angle file, lines of channel, elevation and azimuth in degrees, 16 "
        "or 32 from the highest to the lowest, found {}; give the file that came with the sensor",
        path, found);
  };
  for (std::string line; std::getline(lines, line);) {
    double channel = 0.0, elevation_deg = 0.0, azimuth_deg = 0.0;
    const int read =
        std::sscanf(line.c_str(), "%lf ,%lf ,%lf", &channel, &elevation_deg, &azimuth_deg);
    if (read <= 0) continue;  // names, or nothing
    const bool fits = read == 3 && channel == sensor.rows() + 1 && std::abs(elevation_deg) < 90.0 &&
                      std::abs(azimuth_deg) < kMostAside_deg;
    if (!fits) complain(fmt::format("'{}' behind {} channels", excerpt(line), sensor.rows()));
    sensor.beam_elevation_rad.push_back(elevation_deg * kDegree_rad);
    sensor.beam_azimuth_offset_rad.push_back(hesai_half_firing_rad(scan_period_s) -
                                             azimuth_deg * kDegree_rad);
  }
  if (sensor.rows() != 16 && sensor.rows() != 32) {
    complain(fmt::format("{} channels", sensor.rows()));
  }
  sensor.name = name_of(sensor.rows());
  try {
    validate(sensor);
  } catch (const Error& error) {
    complain(error.what());
  }
  return sensor;
}

std::unique_ptr<StreamScans> open_hesai(StreamReader reader, const OpenOptions& options,
                                        bool with_points) {
  const std::string path = reader.path();
  const HesaiPacket header = first_packet(reader, "a Hesai XT16 or XT32", hesai_packet);
  RecordingInfo info;
  info.sensor = sensor_of(header, options, path, info.warnings);
  info.sensor_known = options.sensor.empty();
  info.format = fmt::format("Hesai XT{} packets, {} return", header.lasers,
                            header.dual_return ? "dual" : "single");
  const DecoderOptions decoding = {options.kept_return, with_points};
  return packet_scans(std::move(reader), std::move(info), [=](const SensorModel& sensor) {
    return std::make_unique<HesaiDecoder>(sensor, decoding, path);
  });
}

}  // namespace hqslam::recordings

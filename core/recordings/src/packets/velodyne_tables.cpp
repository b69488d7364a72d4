#include "packets/velodyne_tables.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>

#include "hqslam/core/error.h"

namespace hqslam::recordings {

namespace {

/// Firing sequences: VLP-16 16 lasers 2.304 us apart, two sequences a block; HDL-32E 32 lasers
/// 1.152 us apart; VLP-32C 16 pairs 2.304 us apart; VLS-128 16 groups of eight 2.665 us apart, one
/// such pause after the eighth group and three after the last, four blocks a sequence (of two
/// returns eight, one sequence a packet); HDL-64E 64 lasers in 48 us, two blocks a sequence.
struct Model {
  std::string_view name;
  VelodyneTiming timing;
};
/// In the order of VelodyneModel.
constexpr std::array<Model, 5> kModels = {
    {{"vlp-16", {0.002, 55.296, 2.0, 1327.104, 663.552, 16, 0x22}},
     {"hdl-32e", {0.002, 46.080, 1.0, 552.960, 276.480, 32, 0x21}},
     {"vlp-32c", {0.004, 55.296, 1.0, 663.552, 331.776, 32, 0x28}},
     {"vls-128", {0.004, 53.300, 0.25, 159.900, 53.300, 128, 0xA1}},
     {"hdl-64e", {0.002, 48.0, 0.5, 288.0, 144.0, 64, 0x00}}}};

const Model& facts(VelodyneModel model) { return kModels[static_cast<std::size_t>(model)]; }

const std::vector<double> kVlp32cElevations_deg = {
    -25.0,  -1.0,   -1.667, -15.639, -11.31, 0.0,    -0.667, -8.843, -7.254, 0.333,  -0.333,
    -6.148, -5.333, 1.333,  0.667,   -4.0,   -4.667, 1.667,  1.0,    -3.667, -3.333, 3.333,
    2.333,  -2.667, -3.0,   7.0,     4.667,  -2.333, -2.0,   15.0,   10.333, -1.333};

const std::vector<double> kVls128Elevations_deg = {
    -11.742, -1.99,   3.4,   -5.29,   -0.78, 4.61,  -4.08,   1.31,   -6.5,  -1.11,   4.28,  -4.41,
    0.1,     6.48,    -3.2,  2.19,    -3.86, 1.53,  -9.244,  -1.77,  2.74,  -5.95,   -0.56, 4.83,
    -2.98,   2.41,    -6.28, -0.89,   3.62,  -5.07, 0.32,    7.58,   -0.34, 5.18,    -3.64, 1.75,
    -25.0,   -2.43,   2.96,  -5.73,   0.54,  9.7,   -2.76,   2.63,   -7.65, -1.55,   3.84,  -4.85,
    3.18,    -5.51,   -0.12, 5.73,    -4.3,  1.09,  -16.042, -2.21,  4.06,  -4.63,   0.76,  15.0,
    -3.42,   1.97,    -6.85, -1.33,   -5.62, -0.23, 5.43,    -3.53,  0.98,  -19.582, -2.32, 3.07,
    -4.74,   0.65,    11.75, -2.65,   1.86,  -7.15, -1.44,   3.95,   -2.1,  3.29,    -5.4,  -0.01,
    4.5,     -4.19,   1.2,   -13.565, -1.22, 4.17,  -4.52,   0.87,   6.08,  -3.31,   2.08,  -6.65,
    1.42,    -10.346, -1.88, 3.51,    -6.06, -0.67, 4.72,    -3.97,  2.3,   -6.39,   -1.0,  4.39,
    -5.18,   0.21,    6.98,  -3.09,   4.98,  -3.75, 1.64,    -8.352, -2.54, 2.85,    -5.84, -0.45,
    8.43,    -2.87,   2.52,  -6.17,   -1.66, 3.73,  -4.96,   0.43};

}  // namespace

std::string_view name(VelodyneModel model) { return facts(model).name; }

std::optional<VelodyneModel> velodyne_model(std::string_view wanted) {
  for (std::size_t i = 0; i < kModels.size(); ++i) {
    if (kModels[i].name == wanted) return static_cast<VelodyneModel>(i);
  }
  return std::nullopt;
}

const VelodyneTiming& timing(VelodyneModel model) { return facts(model).timing; }

double laser_time_us(VelodyneModel model, int laser) {
  const int pair = laser / 2;
  const int group = laser / 8 + laser / 64;
  switch (model) {
    case VelodyneModel::kVlp16:
      return 2.304 * laser;
    case VelodyneModel::kHdl32e:
      return 1.152 * laser;
    case VelodyneModel::kVlp32c:
      return 2.304 * pair;
    case VelodyneModel::kHdl64e:
      return 0.0;
    case VelodyneModel::kVls128:
      break;
  }
  return 2.665 * group;
}

double laser_azimuth_time_us(VelodyneModel model, int laser) {
  return model == VelodyneModel::kVlp32c ? 2.304 * laser : laser_time_us(model, laser);
}

std::vector<double> laser_elevations_deg(VelodyneModel model) {
  std::vector<double> result;
  switch (model) {
    case VelodyneModel::kVlp16:  // -15, 1, -13, 3, ..., -1, 15
      for (int laser = 0; laser < 16; ++laser) {
        result.push_back(laser % 2 == 0 ? laser - 15.0 : laser);
      }
      return result;
    case VelodyneModel::kHdl32e:  // -30.67, -9.33, -29.33, -8.00, ..., -10.67, 10.67
      for (int laser = 0; laser < 32; ++laser) {
        const int pair = laser / 2;
        result.push_back((laser % 2 == 0 ? -92.0 : -28.0) / 3.0 + pair * 4.0 / 3.0);
      }
      return result;
    case VelodyneModel::kVlp32c:
      return kVlp32cElevations_deg;
    case VelodyneModel::kHdl64e:
    case VelodyneModel::kVls128:
      break;
  }
  return kVls128Elevations_deg;
}

std::vector<int> laser_rows(VelodyneModel model) {
  const std::vector<double> elevations_deg = laser_elevations_deg(model);
  std::vector<int> lasers(elevations_deg.size());
  std::iota(lasers.begin(), lasers.end(), 0);
  std::ranges::stable_sort(lasers, std::greater(),
                           [&](int laser) { return elevations_deg[laser]; });
  std::vector<int> rows(lasers.size());
  for (std::size_t row = 0; row < lasers.size(); ++row) rows[lasers[row]] = static_cast<int>(row);
  return rows;
}

int bank_of(std::uint16_t flag) {
  const auto found = std::ranges::find(kBankFlags, flag);
  return found == kBankFlags.end() ? -1 : static_cast<int>(found - kBankFlags.begin());
}

int used_blocks(Bytes payload) {
  constexpr int kReturns = 2;
  constexpr int kBanks = 4;
  for (int i = 0; i < kReturns * kBanks; ++i) {
    if (block_flag(payload, i) != kBankFlags[static_cast<std::size_t>(i / kReturns)]) {
      return kBlocks;
    }
  }
  return kReturns * kBanks;
}

bool is_velodyne_packet(Bytes payload) {
  if (payload.size() != kVelodynePacketBytes) return false;
  // An LSLiDAR's packets differ in their last byte alone, which names a C16 or a C32.
  if (payload[kProductAt] == 0x10 || payload[kProductAt] == 0x20) return false;
  const int blocks = used_blocks(payload);
  for (int i = 0; i < blocks; ++i) {
    if (bank_of(block_flag(payload, i)) < 0 || raw_azimuth(payload, i) > kTurn) return false;
  }
  return little_endian<std::uint32_t>(payload, kTimeAt) < kHour_us;
}

VelodyneChannels channels_of(const VelodyneStream& stream, const SensorModel& sensor) {
  const VelodyneTiming& timing = recordings::timing(stream.model);
  if (sensor.rows() != timing.lasers) {
    throw Error(
        "sensor '{}' has {} rows, expected the {} lasers of a {}; name the sensor that recorded "
        "the packets",
        sensor.name, sensor.rows(), timing.lasers, name(stream.model));
  }
  const std::vector<int> rows = laser_rows(stream.model);
  VelodyneChannels result;
  for (int bank = 0; bank < static_cast<int>(result.size()); ++bank) {
    for (int c = 0; c < kChannels; ++c) {
      const int sequence = timing.lasers < kChannels ? c / timing.lasers : 0;
      const int laser = timing.lasers <= kChannels ? c % timing.lasers : bank * kChannels + c;
      if (laser >= timing.lasers) continue;  // a bank that the model has not
      const int row = rows[laser];
      VelodyneChannel channel;
      channel.row = static_cast<std::uint16_t>(row);
      channel.cos_elevation = static_cast<float>(std::cos(sensor.beam_elevation_rad[row]));
      channel.sin_elevation = static_cast<float>(std::sin(sensor.beam_elevation_rad[row]));
      channel.clockwise = -sensor.beam_azimuth_offset_rad[row] * 18000.0 / std::numbers::pi;
      const double sequence_us = sequence * timing.firing_us;
      channel.time_us = sequence_us + laser_time_us(stream.model, laser);
      channel.azimuth_us = sequence_us + laser_azimuth_time_us(stream.model, laser);
      result[bank].push_back(channel);
    }
  }
  return result;
}

}  // namespace hqslam::recordings

#include "hqslam/core/imu_sample.h"

#include <array>
#include <cmath>
#include <string_view>

#include "hqslam/core/error.h"
#include "hqslam/core/excerpt.h"
#include "hqslam/core/whole_file.h"
#include "hqslam/core/words.h"

namespace hqslam {

namespace {

constexpr std::size_t kMaxImuFileBytes = 1U << 30U;  // more than a day at 100 Hz
constexpr std::size_t kColumns = 7;

}  // namespace

std::vector<ImuSample> read_imu_csv(const std::string& path) {
  const std::string file = whole_file(path, "inertial data", kMaxImuFileBytes);
  std::vector<ImuSample> samples;
  std::string_view rest = file;
  for (int line = 1; !rest.empty(); ++line) {
    const std::string_view text = next_line(rest);
    const std::vector<std::string_view> words = words_of(text, ", \t\r", kColumns + 1);
    if (words.empty() || (line == 1 && !number_from<double>(words.front()))) continue;
    std::array<double, kColumns> numbers{};
    for (std::size_t i = 0; i < kColumns; ++i) {
      const auto number = i < words.size() ? number_from<double>(words[i]) : std::nullopt;
      if (!number || !std::isfinite(*number) || words.size() > kColumns) {
        throw Error(
            "{}:{}: expected 7 numbers (stamp in seconds, angular rate x y z in rad/s, specific "
            "force x y z in m/s^2), found '{}'; correct or remove the line",
            path, line, excerpt(text));
      }
      numbers[i] = *number;
    }
    if (!samples.empty() && !(numbers[0] > samples.back().stamp_s)) {
      throw Error("{}:{}: expected a stamp after {} s, found {} s; sort the lines", path, line,
                  samples.back().stamp_s, numbers[0]);
    }
    samples.push_back(
        {numbers[0], {numbers[1], numbers[2], numbers[3]}, {numbers[4], numbers[5], numbers[6]}});
  }
  if (samples.empty()) {
    throw Error("{}: expected lines of 7 numbers, found none; give a file of inertial data", path);
  }
  return samples;
}

}  // namespace hqslam

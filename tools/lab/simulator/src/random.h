#pragma once

#include <cstdint>

namespace hqslam::sim {

/// Scrambles 64 bits: the finaliser of splitmix64 (Steele, Lea, Flood 2014).
constexpr std::uint64_t scrambled(std::uint64_t bits) {
  bits += 0x9e3779b97f4a7c15ULL;
  bits = (bits ^ (bits >> 30U)) * 0xbf58476d1ce4e5b9ULL;
  bits = (bits ^ (bits >> 27U)) * 0x94d049bb133111ebULL;
  return bits ^ (bits >> 31U);
}

/// A seed for one of many uses; it does not depend on the order of the calls.
constexpr std::uint64_t seed_of(std::uint64_t seed, std::uint64_t key) {
  return scrambled(scrambled(seed) ^ (key * 0xd6e8feb86659fd93ULL));
}
constexpr std::uint64_t seed_of(std::uint64_t seed, std::uint64_t key, std::uint64_t second_key) {
  return seed_of(seed_of(seed, key), second_key);
}

/// The parts of a drive, each with a seed of its own.
enum class DrivePart { kCity = 1, kPath, kSway, kTraffic, kNoise, kConditions, kErrors, kImu };
constexpr std::uint64_t seed_of(std::uint64_t drive_seed, DrivePart part) {
  return seed_of(drive_seed, static_cast<std::uint64_t>(part));
}

/// 64 random bits as a number in [0, 1).
constexpr double uniform_of(std::uint64_t bits) {
  return static_cast<double>(bits >> 11U) * 0x1.0p-53;
}

/// 64 random bits as a number of mean 0 and variance 1: the sum of four uniform numbers (hence
/// never beyond 3.47). Bit-exact everywhere, which a logarithm and a cosine are not.
constexpr double normal_of(std::uint64_t bits) {
  double sum = 0.0;
  for (unsigned part = 0; part < 4; ++part) {
    sum += (static_cast<double>((bits >> (16U * part)) & 0xffffU) + 0.5) * 0x1.0p-16;
  }
  return (sum - 2.0) * 1.7320508075688772;
}

/// A sequence of random numbers that is the same on every machine.
class Random {
 public:
  explicit constexpr Random(std::uint64_t seed) : state_(scrambled(seed)) {}

  constexpr std::uint64_t bits() { return scrambled(state_ += 0x9e3779b97f4a7c15ULL); }
  constexpr double uniform() { return uniform_of(bits()); }
  constexpr double uniform(double low, double high) { return low + (high - low) * uniform(); }
  constexpr double normal() { return normal_of(bits()); }
  constexpr bool chance(double probability) { return uniform() < probability; }
  /// 0 .. count-1.
  constexpr int below(int count) { return static_cast<int>(uniform() * count); }
  constexpr std::uint8_t shade() { return static_cast<std::uint8_t>(bits() >> 56U); }

 private:
  std::uint64_t state_;
};

}  // namespace hqslam::sim

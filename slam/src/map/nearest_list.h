#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace hqslam::slam {

/// The kCount points nearest to a query so far, nearest first. Each is one number, the squared
/// distance in the upper and the place of the point in the lower bits, so that comparisons need no
/// branch, which a processor could mispredict.
template <int kCount>
class NearestList {
 public:
  /// Points beyond reach are not counted.
  explicit NearestList(float reach_m2) { numbers_.fill(number(reach_m2, 0)); }

  void insert(float squared_m2, std::uint32_t place) {
    std::uint64_t inserted = number(squared_m2, place);
    for (std::uint64_t& number : numbers_) {
      const std::uint64_t before = number;
      number = inserted < before ? inserted : before;
      inserted = inserted < before ? before : inserted;
    }
  }

  /// That of the reach if there are no more than i points.
  float squared_m2(int i) const {
    return std::bit_cast<float>(static_cast<std::uint32_t>(numbers_[i] >> 32));
  }
  std::uint32_t place(int i) const { return static_cast<std::uint32_t>(numbers_[i]); }
  /// The distance of the last one.
  float bound_m2() const { return squared_m2(kCount - 1); }

 private:
  /// The order of floats that are not negative is that of their bits.
  static std::uint64_t number(float squared_m2, std::uint32_t place) {
    return std::uint64_t{std::bit_cast<std::uint32_t>(squared_m2)} << 32 | place;
  }

  std::array<std::uint64_t, kCount> numbers_;
};

}  // namespace hqslam::slam

#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace hqslam::slam {

/// A hash from the coordinates of a cell of space to its number, the count of those added before
/// it, by open addressing with steps of one; at most half of the slots are taken. Slots have four
/// bytes, so that those of one row of a scan stay in the nearest cache.
class CellIndex {
 public:
  static constexpr std::uint32_t kNone = 0xFFFFFFFFU;
  /// Coordinates are from -kRange to kRange - 1.
  static constexpr int kRange = 1 << 20;

  /// In: a cell within that range.
  static std::uint64_t key_of(const Eigen::Vector3i& cell) {
    const auto bits = [](int value) {
      return static_cast<std::uint64_t>(std::int64_t{value} + kRange);
    };
    return bits(cell.x()) << 42 | bits(cell.y()) << 21 | bits(cell.z());
  }

  static Eigen::Vector3i cell_of(std::uint64_t key) {
    const auto value = [](std::uint64_t bits) {
      return static_cast<int>(bits & 0x1FFFFFU) - kRange;
    };
    return {value(key >> 42), value(key >> 21), value(key)};
  }

  /// The number of a cell; kNone if it was not added or is out of range.
  std::uint32_t find(std::uint64_t key) const { return slots_[slot_of(key)]; }
  std::uint32_t find(const Eigen::Vector3i& cell) const {
    const bool is_within = (cell.array() >= -kRange).all() && (cell.array() < kRange).all();
    return is_within ? find(key_of(cell)) : kNone;
  }

  /// The number of a cell, which is added if it is not there yet.
  std::uint32_t find_or_add(std::uint64_t key) {
    if (2 * (keys_.size() + 1) > slots_.size()) grow();
    std::uint32_t& number = slots_[slot_of(key)];
    if (number == kNone) {
      number = static_cast<std::uint32_t>(keys_.size());
      keys_.push_back(key);
    }
    return number;
  }

  void clear() { *this = {}; }

 private:
  /// The slot of the key, or the empty one for it.
  std::size_t slot_of(std::uint64_t key) const {
    std::uint64_t mixed = key ^ key >> 31;
    mixed *= 0x9E3779B97F4A7C15ULL;
    const std::size_t mask = slots_.size() - 1;
    std::size_t slot = (mixed ^ mixed >> 29) & mask;
    while (slots_[slot] != kNone && keys_[slots_[slot]] != key) slot = (slot + 1) & mask;
    return slot;
  }

  void grow() {
    slots_.assign(2 * slots_.size(), kNone);
    for (std::uint32_t i = 0; i < keys_.size(); ++i) slots_[slot_of(keys_[i])] = i;
  }

  std::vector<std::uint64_t> keys_;  ///< of the cells, by their numbers
  std::vector<std::uint32_t> slots_ = std::vector<std::uint32_t>(1024, kNone);
};

}  // namespace hqslam::slam

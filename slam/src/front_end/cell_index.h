#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace hqslam::slam {

/// A hash from the coordinates of a cell of space to its number, by open addressing with steps of
/// one; at most half of the slots are taken.
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
  std::uint32_t find(std::uint64_t key) const { return slots_[slot_of(key)].number; }
  std::uint32_t find(const Eigen::Vector3i& cell) const {
    const bool is_within = (cell.array() >= -kRange).all() && (cell.array() < kRange).all();
    return is_within ? find(key_of(cell)) : kNone;
  }

  /// Adds a cell that is not there yet.
  void add(std::uint64_t key, std::uint32_t number) {
    if (2 * ++size_ > slots_.size()) grow();
    slots_[slot_of(key)] = {key, number};
  }

  void clear() { *this = {}; }

 private:
  struct Slot {
    std::uint64_t key = 0;
    std::uint32_t number = kNone;
  };

  /// The slot of the key, or the empty one for it.
  std::size_t slot_of(std::uint64_t key) const {
    std::uint64_t mixed = key ^ key >> 31;
    mixed *= 0x9E3779B97F4A7C15ULL;
    const std::size_t mask = slots_.size() - 1;
    std::size_t slot = (mixed ^ mixed >> 29) & mask;
    while (slots_[slot].number != kNone && slots_[slot].key != key) slot = (slot + 1) & mask;
    return slot;
  }

  void grow() {
    std::vector<Slot> before(2 * slots_.size());
    before.swap(slots_);
    for (const Slot& slot : before) {
      if (slot.number != kNone) slots_[slot_of(slot.key)] = slot;
    }
  }

  std::size_t size_ = 0;
  std::vector<Slot> slots_ = std::vector<Slot>(1024);
};

}  // namespace hqslam::slam

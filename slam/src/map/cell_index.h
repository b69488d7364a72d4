#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace hqslam::slam {

/// Finds cells of space by their coordinates: for each cell that was added its number, in the same
/// time however many there are. Open addressing with steps of one; at most half of the slots are
/// taken.
class CellIndex {
 public:
  static constexpr std::uint32_t kNone = 0xFFFFFFFFU;
  /// Coordinates are from -kRange to kRange - 1.
  static constexpr int kRange = 1 << 20;

  /// In: a cell within that range.
  static std::uint64_t key_of(const Eigen::Vector3i& cell) {
    const auto part = [](int value) {
      return static_cast<std::uint64_t>(std::int64_t{value} + kRange);
    };
    return part(cell.x()) << 42 | part(cell.y()) << 21 | part(cell.z());
  }

  static Eigen::Vector3i cell_of(std::uint64_t key) {
    const auto part = [](std::uint64_t bits) {
      return static_cast<int>(bits & 0x1FFFFFU) - kRange;
    };
    return {part(key >> 42), part(key >> 21), part(key)};
  }

  /// The number of a cell; kNone if it is not there, or out of range.
  std::uint32_t find(std::uint64_t key) const { return slots_[slot_of(key)].number; }
  std::uint32_t find(const Eigen::Vector3i& cell) const {
    const bool is_within = (cell.array() >= -kRange).all() && (cell.array() < kRange).all();
    return is_within ? find(key_of(cell)) : kNone;
  }

  /// The number of a cell, which is added as number `next` if it is not there.
  std::uint32_t find_or_add(std::uint64_t key, std::size_t next) {
    const std::uint32_t found = find(key);
    if (found != kNone) return found;
    add(key, static_cast<std::uint32_t>(next));
    return static_cast<std::uint32_t>(next);
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

  /// Where the key is, or the empty slot where it would be.
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

/// Cells of a plane, in squares of 64 x 64 that are there where anything was said of one.
template <typename Cell>
class CellChunks {
 public:
  static constexpr int kShift = 6;
  static constexpr int kSide = 1 << kShift;

  /// nullptr where nothing is.
  const Cell* find(const Eigen::Vector2i& cell) const {
    const std::uint32_t number = index_.find(chunk_of(cell));
    return number == CellIndex::kNone ? nullptr : &chunks_[number].second[local_of(cell)];
  }
  Cell* find(const Eigen::Vector2i& cell) {
    return const_cast<Cell*>(std::as_const(*this).find(cell));
  }
  /// A cell within kSide times CellIndex's range.
  Cell& find_or_add(const Eigen::Vector2i& cell) {
    const std::uint32_t number =
        index_.find_or_add(CellIndex::key_of(chunk_of(cell)), chunks_.size());
    if (number == chunks_.size()) {
      chunks_.emplace_back(chunk_of(cell).head<2>() * kSide,
                           std::vector<Cell>(std::size_t{kSide} * kSide));
    }
    return chunks_[number].second[local_of(cell)];
  }
  /// Calls visit(cell, value) for each cell of each square.
  template <typename Visit>
  void for_each(const Visit& visit) const {
    for (const auto& [corner, cells] : chunks_) {
      for (std::size_t i = 0; i < cells.size(); ++i) {
        const auto local = static_cast<int>(i);
        visit(Eigen::Vector2i(corner + Eigen::Vector2i(local % kSide, local / kSide)), cells[i]);
      }
    }
  }

 private:
  static Eigen::Vector3i chunk_of(const Eigen::Vector2i& cell) {
    return {cell.x() >> kShift, cell.y() >> kShift, 0};
  }
  static std::size_t local_of(const Eigen::Vector2i& cell) {
    return static_cast<std::size_t>((cell.x() & (kSide - 1)) | (cell.y() & (kSide - 1)) << kShift);
  }

  /// Cell of the lower left corner, and the cells.
  std::vector<std::pair<Eigen::Vector2i, std::vector<Cell>>> chunks_;
  CellIndex index_;
};

}  // namespace hqslam::slam

#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "front_end/cell_index.h"

namespace hqslam::slam {

/// Cells of a plane, in squares of 64 x 64 that exist where a cell was added.
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
    const std::uint32_t number = index_.find_or_add(CellIndex::key_of(chunk_of(cell)));
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

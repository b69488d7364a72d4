#include "row_selection.h"

#include <fmt/format.h>

#include <cstdint>

#include "hqslam/core/error.h"

namespace hqslam {

std::vector<int> selected_rows(int rows, RowSelection selection) {
  if (selection.offset < 0 || selection.offset >= rows || selection.stride < 1) {
    throw Error(
        fmt::format("row selection {}:{} does not fit {} rows: expected an offset of 0 to {} and a "
                    "stride of 1 or more",
                    selection.offset, selection.stride, rows, rows - 1));
  }
  std::vector<int> selected;
  // 64 bits: the row after the last may be beyond what an int holds.
  for (std::int64_t row = selection.offset; row < rows; row += selection.stride) {
    selected.push_back(static_cast<int>(row));
  }
  return selected;
}

}  // namespace hqslam

#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "hqslam/core/point_columns.h"

namespace hqslam {

/// Points as a .las file has them (see write_cloud).
class LasPoints {
 public:
  /// What the columns point to must outlive it. Throws Error for a coordinate of more than
  /// 2,147,483 m and for more points than LAS can count; `path` stands for the file in messages.
  LasPoints(const std::vector<PointColumn>& columns, std::size_t points, const std::string& path);
  /// What comes before the points.
  std::string header() const;
  void append(std::size_t point, std::string& bytes) const;

 private:
  double number(const PointColumn& column, std::size_t point) const;

  const std::vector<PointColumn>& columns_;
  std::size_t points_;
  const PointColumn* intensity_ = nullptr;
  const PointColumn* time_ = nullptr;
  std::vector<const PointColumn*> extra_;
  std::size_t point_bytes_ = 0;
  double intensity_steps_ = 1.0;  ///< per unit
  double low_m_[3] = {}, high_m_[3] = {};
};

}  // namespace hqslam

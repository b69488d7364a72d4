#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <deque>
#include <vector>

#include "hqslam/core/pose.h"
#include "hqslam/core/range_image.h"
#include "hqslam/core/sensor_model.h"

namespace hqslam::nn {

struct KeptScan {
  double stamp_s = 0.0;
  Pose T_world_sensor;
  double path_m = 0.0;                    ///< since the first scan of all
  std::vector<Eigen::Vector3f> points_m;  ///< world frame, relative to the origin; NaN: forgotten
  /// Of each point, the head's in the scan that saw or recalled it last: where the next looks
  /// first.
  std::vector<std::int16_t> columns;
};

/// Where a point falls.
struct Hit {
  std::int16_t row = 0;
  std::int16_t column = 0;
  float range_m = 0.0F;
  float u = 0.0F;  ///< from the pixel's centre to the right, in columns
  float v = 0.0F;  ///< downwards, in rows
  float worth = 0.0F;
};

/// A pose that takes points of the world into the sensor.
struct PoseFloat {
  Eigen::Matrix3f R_sensor_world;
  Eigen::Vector3f position_m;

  Eigen::Vector3f operator()(const Eigen::Vector3f& p) const {
    return R_sensor_world * (p - position_m);
  }
};

/// Into which pixels of a scan the points of earlier ones fall; hqslam/nn/scan_memory.h says how.
class MemoryProjection {
 public:
  /// sensor: all rows, and which of them are measured. Throws Error where it does not say.
  explicit MemoryProjection(const SensorModel& sensor);

  /// poses: one for each column of the image, or one for all. Points that measured beams pass
  /// become NaN.
  void project(std::deque<KeptScan>& kept, const RangeImage& measured,
               const std::vector<PoseFloat>& poses);
  /// Of each kept scan.
  const std::vector<std::vector<Hit>>& hits() const { return hits_; }
  /// Of the hits of each pixel; HUGE_VALF where there is none.
  const std::vector<float>& nearest_m() const { return nearest_m_; }
  std::size_t pixel_of(const Hit& hit) const {
    return static_cast<std::size_t>(hit.row) * sensor_.columns + hit.column;
  }

 private:
  int row_of(float sine) const;
  bool find_hit(const Eigen::Vector3f& point_m, const std::vector<PoseFloat>& poses,
                std::int16_t& seen_in_column, Hit& hit) const;
  bool is_passed(const Hit& hit, const RangeImage& measured) const;
  void project_scan(KeptScan& scan, const RangeImage& measured, const std::vector<PoseFloat>& poses,
                    std::vector<Hit>& of_scan, std::vector<float>& nearest) const;

  SensorModel sensor_;
  RowSelection measured_rows_;
  float columns_per_rad_;
  float least_m_;
  float most_m_;
  std::vector<float> sine_;             ///< of each row's elevation, falling
  std::vector<float> azimuth_of_edge_;  ///< of the left edge of column 0, of each row
  std::vector<int> column_shift_;       ///< SensorModel::column_shift of each row
  std::vector<float> per_sine_above_;   ///< rows a unit of sine, towards the row above
  std::vector<float> per_sine_below_;
  std::vector<float> lower_edge_;          ///< the sine between each row and the next
  std::vector<std::int16_t> row_of_sine_;  ///< of the upper end of each part of -1 to 1
  std::array<float, 513> worth_;           ///< exp(-4 d^2) of each part of d^2 up to 1/2
  std::vector<std::vector<Hit>> hits_;
  std::vector<float> nearest_m_;
};

}  // namespace hqslam::nn

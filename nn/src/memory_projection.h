#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "hqslam/core/pose.h"
#include "hqslam/core/range_image.h"
#include "hqslam/core/sensor_model.h"
#include "kernels/row_kernels.h"

namespace hqslam::nn {

/// The points of one scan, a value of each after the other, padded to whole vectors of 16.
struct KeptScan {
  double stamp_s = 0.0;
  Pose T_world_sensor;
  double path_m = 0.0;     ///< since the first scan of all
  std::vector<float> x_m;  ///< world frame, relative to the origin; NaN: forgotten, or padding
  std::vector<float> y_m;
  std::vector<float> z_m;
  std::vector<float> head_offset;  ///< of the row that last measured or recalled it
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

/// The sensor while its head turns (kernels::SeePoints).
struct HeadMotion {
  /// Elements of R_sensor_world, row by row, and of the sensor's position, as cubics in the place
  /// of the head in its turn.
  std::array<float[4], 12> elements;
  float first_column = 0.0F;
};

/// Finds the pixels of a scan into which the points of earlier ones fall (hqslam/nn/scan_memory.h).
class MemoryProjection {
 public:
  /// Bands of rows of an image that are worked on side by side.
  static constexpr int kBands = 8;

  /// sensor: all rows, and which of them are measured. Throws Error without measured rows.
  explicit MemoryProjection(const SensorModel& sensor);

  /// How far behind the head the pixels of a row are, in columns: the head is at column
  /// head_offset - turn when the row measures at an azimuth of `turn` columns.
  float head_offset(int row) const { return head_offset_[row]; }

  /// poses: one for each column of the image, or one for all; origin_m: of the kept points. Points
  /// that measured beams pass become NaN. The scan with the stamp itself_s has no hits.
  void project(std::deque<KeptScan>& kept, const RangeImage& measured,
               const std::vector<Pose>& T_world_sensor, const Eigen::Vector3d& origin_m,
               std::optional<double> itself_s);
  /// The hits in a band of rows of the points of a kept scan.
  const std::vector<Hit>& hits(std::size_t scan, int band) const { return hits_[scan][band]; }
  std::size_t scans() const { return hits_.size(); }
  int first_row(int band) const { return sensor_.rows() * band / kBands; }
  /// The range of the nearest hit of each pixel; HUGE_VALF where there is none.
  const std::vector<float>& nearest_m() const { return nearest_m_; }
  std::size_t pixel_of(const Hit& hit) const {
    return static_cast<std::size_t>(hit.row) * sensor_.columns + hit.column;
  }

 private:
  using Bands = std::array<std::vector<Hit>, kBands>;

  HeadMotion motion_through(const std::vector<Pose>& T_world_sensor,
                            const Eigen::Vector3d& origin_m) const;
  int row_of(float sine) const;
  bool find_hit(float range_m, float sine, float turn, Hit& hit) const;
  bool is_passed(const Hit& hit, const RangeImage& measured) const;
  void project_scan(KeptScan& scan, const RangeImage& measured, const HeadMotion& motion,
                    Bands& bands, std::vector<float>& nearest) const;

  SensorModel sensor_;
  RowSelection measured_rows_;
  const kernels::RowKernels& kernels_;
  float least_m_;
  float most_m_;
  std::vector<float> sine_;            ///< of each row's elevation, falling
  std::vector<float> edge_;            ///< of each row, the turn at the left edge of column 0
  std::vector<float> head_offset_;     ///< edge_ with the row's column shift
  std::vector<float> per_sine_above_;  ///< rows a unit of sine, towards the row above
  std::vector<float> per_sine_below_;
  std::vector<float> lower_edge_;          ///< the sine between each row and the next
  std::vector<std::int16_t> row_of_sine_;  ///< of the upper end of each part of -1 to 1
  std::vector<int> measured_above_;        ///< the last measured row not below each; -1: none
  std::vector<std::int16_t> band_;         ///< of each row
  std::array<float, 513> worth_;           ///< exp(-4 d^2) of each part of d^2 up to 1/2
  Eigen::Matrix<double, 4, Eigen::Dynamic> cubic_through_columns_;
  std::vector<Bands> hits_;
  std::vector<float> nearest_m_;
};

}  // namespace hqslam::nn

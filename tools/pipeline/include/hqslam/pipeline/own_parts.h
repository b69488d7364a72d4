#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hqslam/core/connected_components.h"
#include "hqslam/core/organized_cloud.h"
#include "hqslam/core/range_image.h"
#include "hqslam/core/sensor_model.h"

namespace hqslam::pipeline {

/// Finds the parts of a vehicle that its sensor sees, or of a person who carries it: near pixels
/// that keep their range while the sensor moves. In maps such parts would be at every pose.
///
/// - A pixel is constant once its range has stayed within 0.1 m for 10 scans, and until three
///   successive scans see something else there.
/// - The sensor moves where fewer than half of the pixels beyond 3 m are constant.
/// - Nearer pixels that were constant in 20 scans of a moving sensor are candidates. So is a wall
///   or floor beside a straight way; but that goes on beyond the candidates, while own parts end:
///   of the pixels around a component of candidates at most a fifth are on the same surface. Near
///   ones that never changed do not count: they only take longer, as their echoes are few.
///
/// A pixel that sees something else for more than 10 scans is no own part any more.
class OwnParts {
 public:
  /// sensor: of the scans.
  explicit OwnParts(const SensorModel& sensor);

  /// The scan, with no return where it sees own parts. In: the scans of a drive in their order, of
  /// the sensor's rows and columns; throws Error for others.
  OrganizedCloud without(OrganizedCloud scan);
  double share() const;  ///< of all pixels
  /// "812 of 28800 pixels, 0.4 to 1.5 m away", of the last scan; empty if there are none.
  std::string text() const;

 private:
  struct Pixel {
    float range_m = 0.0F;           ///< mean of the scans in `constant`
    std::uint8_t constant = 0;      ///< scans, counted up to 10
    std::uint8_t while_moving = 0;  ///< scans, counted up to 20
    std::uint8_t different = 0;     ///< successive scans in which something else was seen
    bool has_changed = false;       ///< something else was seen before
    bool is_own = false;
  };

  static int most_different(const Pixel& pixel);
  void observe(const std::vector<float>& range_m);
  bool is_moving() const;
  RangeImage candidates(const std::vector<float>& range_m);
  std::vector<bool> end_there(const RangeImage& candidates, const ConnectedComponents& found,
                              const std::vector<float>& range_m) const;

  SensorModel sensor_;
  ComponentLabeler labeler_;
  std::vector<Pixel> pixels_;
  int scans_ = 0;
};

}  // namespace hqslam::pipeline

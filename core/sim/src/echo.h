#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "hqslam/core/sensor_model.h"
#include "hqslam/sim/drive.h"
#include "ray_scene.h"

namespace hqslam::sim {

/// What one ray of the beam's footprint brings back.
struct Echo {
  double range_m = 0.0;
  double signal = 0.0;  ///< q of lidar.h, per ray
};

/// Random bits of a pixel and of the patch of pixels around it: what glass does is alike in
/// neighbouring pixels.
struct PixelBits {
  std::uint64_t pixel = 0;
  std::uint64_t patch = 0;
};

/// The echo of a hit; none if glass lets the ray through for good.
std::optional<Echo> echo_of(const RayHit& hit, double max_range_m, const PixelBits& bits);

bool is_glass(Material material);
/// The range of what a ray sees through the glass that it hits: curtains or a room behind a window,
/// the seats of a car.
double range_through_glass_m(const RayHit& hit);

/// What the rays of one pixel bring back, five at most: the central one counts as much as two
/// others.
class Footprint {
 public:
  void add(const Echo& echo, double weight) { parts_[count_++] = {echo, weight}; }
  /// The one echo that the sensor reports, before noise. None if nothing came back.
  std::optional<Echo> reported_echo() const;

 private:
  struct Part {
    Echo echo;
    double weight;
  };
  std::array<Part, 5> parts_;
  std::size_t count_ = 0;
};

/// Range after detection and noise; 0 if nothing is detected.
float detected_range_m(const Echo& echo, double min_range_m, double max_range_m,
                       std::uint64_t random_bits);

/// The share of a signal that rain or fog lets through to a surface at `range_m` and back.
double transmission(double extinction_per_m, double range_m);

/// What a pixel that would report `range_m` (0: nothing) reports under these conditions; lidar.h
/// has the formulas. Without any it is `range_m` itself.
float disturbed_range_m(float range_m, const SensingConditions& conditions,
                        const SensorModel& sensor, std::uint64_t random_bits);

}  // namespace hqslam::sim

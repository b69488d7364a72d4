#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "hqslam/core/sensor_model.h"
#include "hqslam/sim/drive.h"
#include "ray_scene.h"

namespace hqslam::sim {

/// Half of the beam's divergence: 3 mrad in all, between those of the presets' sensors.
constexpr double kHalfDivergence_rad = 0.0015;

/// The echo of one ray of the beam's footprint.
struct Echo {
  double range_m = 0.0;
  double signal = 0.0;  ///< q of lidar.h, per ray
};

/// Random bits of a pixel and of the patch of pixels around it: glass behaves alike in neighbouring
/// pixels.
struct PixelBits {
  std::uint64_t pixel = 0;
  std::uint64_t patch = 0;
};

/// Errors of a pulse, which depend on the surface; a perfect sensor has the defaults. An echo of
/// signal q at range r, from a surface whose normal is at an angle a to the ray, is changed by
///   range  -= min(incidence_share r d tan a, 0.2 m), d half of the beam's divergence: a slanting
///             footprint is r d tan a deep to either side, and what is nearer answers first. Up to
///             0.2 m were measured with an HDL-32E and an RS-LiDAR-16 (Laconte et al., "Lidar
///             measurement bias estimation via return waveform modelling", ICRA 2019).
///   range  += walk_m (4 - q) / (4 + q): a weak echo passes the receiver's threshold later than a
///             strong one; centimetres (Sedek et al., "Real-time walk error compensation", Sensors
///             24, 2024).
///   signal *= signal_share: what an aged laser or a dirty window leaves; it takes what is dark or
///             far first.
///   intensity *= 1 + intensity_scatter n, n of unit variance, of each return anew: speckle, and
///             the noise of a receiver that was made to tell times.
/// A share mixed_share of the returns at depth edges is between two surfaces up to 2 m apart
/// (Tuley et al., "Analysis and removal of artifacts in 3-D LADAR data", ICRA 2005).
/// Their sizes are chosen within what is published, not measured with one sensor.
struct PulseErrors {
  double incidence_share = 0.0;
  double walk_m = 0.0;
  double signal_share = 1.0;
  double mixed_share = 0.0;
  double intensity_scatter = 0.0;
};
PulseErrors pulse_errors(SensorErrors errors);
Echo with_errors(const Echo& echo, double cos_incidence, const PulseErrors& errors);

/// The echo of a hit; none if glass lets the ray through for good.
std::optional<Echo> echo_of(const RayHit& hit, double max_range_m, const PixelBits& bits);

bool is_glass(Material material);
/// The range of the surface behind the glass that a ray hits: curtains or a room behind a window,
/// the seats of a car.
double range_through_glass_m(const RayHit& hit);

/// The echoes of the rays of one pixel, at most five; the central one has the weight of two others.
class Footprint {
 public:
  void add(const Echo& echo, double weight) { parts_[count_++] = {echo, weight}; }
  /// The one echo that the sensor reports, before noise. None if there is no echo.
  std::optional<Echo> reported_echo(double mixed_share = 0.0, std::uint64_t random_bits = 0) const;

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

/// The intensity that a sensor reports of an echo; lidar.h has the formula.
std::uint8_t intensity_of(const Echo& echo, double max_range_m);

/// A pixel's return (range 0: none) under these conditions; lidar.h has the formulas.
struct Return {
  float range_m = 0.0F;
  std::uint8_t intensity = 0;
};
Return disturbed_return(Return measured, const SensingConditions& conditions,
                        const SensorModel& sensor, std::uint64_t random_bits);

}  // namespace hqslam::sim

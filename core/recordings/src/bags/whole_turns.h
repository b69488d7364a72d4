#pragma once

#include <optional>
#include <vector>

#include "hqslam/core/point_fields.h"

namespace hqslam::recordings {

/// How long a turn of the sensor takes where messages are not one turn each but parts of one or
/// several: by azimuths and times of the points of messages that come every period_s and last as
/// long. Nothing where a message is a turn, or where their points do not determine it.
std::optional<double> turn_of_parts_s(const std::vector<RawPoints>& messages, double period_s);

/// Points of messages that are not one turn each -> scans of one turn, cut by the points' times.
///
/// In:  scans of messages, in order, each point with its time.
/// Out: scans of turn_s each, the first from the first point on; the stamp is their middle. What is
///      left at the end, or before a gap of a turn, is a scan from three quarters of a turn on.
class WholeTurns {
 public:
  explicit WholeTurns(double turn_s) : turn_s_(turn_s) {}
  void add(const Scan& part);
  void finish();
  std::optional<Scan> next();

 private:
  void cut(double end_s);

  double turn_s_;
  double begin_s_ = 0.0;
  double last_s_ = 0.0;
  Scan open_;  ///< since begin_s_; time offsets from there
  std::vector<Scan> whole_;
};

}  // namespace hqslam::recordings

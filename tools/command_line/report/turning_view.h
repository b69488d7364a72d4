#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "hqslam/core/pose.h"

namespace hqslam::tools {

/// Points under a name, in metres; confidence: 0 to 1 each, or empty where nothing is known of it;
/// intensity: the same, in any unit.
struct ViewCloud {
  std::string name;
  std::vector<Eigen::Vector3f> points_m;
  std::vector<float> confidence = {};
  std::vector<float> intensity = {};
};

/// A scan as it was measured, and what was computed between, in the frame of the clouds.
struct ViewScan {
  std::string name;
  std::int64_t number = 0;  ///< by which links call it
  Pose T_map_sensor = Pose::Identity();
  ViewCloud measured;
  ViewCloud upsampled;  ///< without points: nothing was computed
};

/// What a view shows: everything in one frame, z upwards.
struct TurningView {
  std::vector<ViewCloud> clouds;                     ///< of which one is seen at a time
  std::vector<std::vector<Eigen::Vector3f>> path_m;  ///< in pieces where the way is not known
  std::vector<std::pair<Eigen::Vector3f, Eigen::Vector3f>> loops_m;  ///< places that are the same
  std::vector<ViewScan> scans;
};

/// What a page may have of points of 4 bytes (5 with an intensity), so that it stays below 15 MB
/// with its pictures.
inline constexpr std::size_t kMostCloudPoints = 1'200'000;
inline constexpr std::size_t kMostScanPoints = 700'000;

/// Of a page's style and for its body: a view of points that is turned, moved and zoomed with
/// mouse, fingers or keys, and steps through the scans. WebGL 2, no other file, no network; a
/// browser without it shows a line of text. Points are thinned to what a page may have.
extern const char* const kTurningViewStyle;
extern const char* const kTurningViewScript;  ///< draws them; it is in what follows
std::string turning_view_html(const TurningView& view);
/// What such a page knows of the view, as JSON. A page that goes on calls renew(data) of its
/// element .turning-view with what there is now, of as many clouds: it is seen from where the last
/// was.
std::string turning_view_data(const TurningView& view);

}  // namespace hqslam::tools

#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace hqslam::tools {

/// A trajectory from above in the reference's frame, with its error at every pose.
struct ErrorPanel {
  std::string title;
  double rmse_m = 0.0;
  std::vector<Eigen::Vector2d> path_m;
  std::vector<double> error_m;  ///< one per pose
};

/// The paper's figure 2: trajectories of one drive, coloured by their error, side by side.
struct ErrorMap {
  std::vector<Eigen::Vector2d> reference_m;
  std::vector<ErrorPanel> panels;
};

/// Which error has the last colour, in every panel.
struct ErrorScale {
  double top_m = 1.0;
  bool clipped = false;  ///< some errors are larger
};
/// The largest error of all panels, but at most three times the median of the panels' largest
/// ones: one trajectory that leaves the map does not take the colours from all others.
ErrorScale error_scale(const ErrorMap& map);

/// "0.42 m", with "or more" where errors are larger.
std::string top_text(const ErrorScale& scale);

/// "RMSE 0.109, largest 0.31 m"
std::string error_text(const ErrorPanel& panel);

/// One panel, without its title, as an SVG element: the reference in grey, the trajectory in
/// colours with a ring at its start, a scale bar.
std::string panel_svg(const ErrorMap& map, std::size_t panel, const ErrorScale& scale);

/// All panels with their titles and a colour bar, as an .svg file. `title` stands above. Throws
/// Error if there is no panel.
std::string error_map_svg(const ErrorMap& map, const std::string& title);

}  // namespace hqslam::tools

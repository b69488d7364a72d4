#include "view/view_command.h"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <memory>

#include "files/result_files.h"
#include "hqslam/core/error.h"
#include "hqslam/core/left_out.h"
#include "hqslam/core/point_fields.h"
#include "hqslam/core/projection.h"
#include "hqslam/slam/saved_map.h"
#include "pages/page.h"
#include "pages/turning_view.h"
#include "recording/recording_choice.h"
#include "terminal/command_options.h"
#include "terminal/terminal.h"

namespace hqslam::tools {
namespace {

ViewCloud cloud_of(Scan points) {
  return {"", std::move(points.points_m), std::move(points.confidence),
          std::move(points.intensity)};
}

ViewCloud saved_map_in(const std::string& path) {
  const slam::SavedMap map = slam::read_saved_map(path);
  ViewCloud cloud;
  const auto add = [&](const std::vector<Eigen::Vector3f>& points_m,
                       const std::vector<float>& intensity) {
    cloud.points_m.insert(cloud.points_m.end(), points_m.begin(), points_m.end());
    cloud.intensity.insert(cloud.intensity.end(), intensity.begin(), intensity.end());
    cloud.intensity.resize(cloud.points_m.size(), std::numeric_limits<float>::quiet_NaN());
  };
  add(map.edges_m, map.edges_intensity);
  add(map.posts_m, map.posts_intensity);
  add(map.planes_m, map.planes_intensity);
  const bool is_any_known =
      !map.edges_intensity.empty() || !map.posts_intensity.empty() || !map.planes_intensity.empty();
  if (!is_any_known) cloud.intensity.clear();
  return cloud;
}

ViewCloud scan_of(const std::string& path, const ViewOptions& options) {
  pipeline::UpsampledRecording input = upsampled_recording({path, options.sensor}, {});
  LeftOut left_out;
  for (std::int64_t used = 0;; ++used) {
    const std::optional<RecordedScan> scan = next_usable(input.recording, left_out);
    const std::int64_t i = used + left_out.scans;  // those left out count
    if (scan && i == options.scan)
      return cloud_of(returns_of(input.upsampler.measured(scan->cloud)));
    if (scan && i < options.scan) continue;
    throw Error("{}: expected a scan {}, found {} scans{}; --scan counts them from 0", path,
                options.scan, used, left_out.scans > 0 ? " that can be used" : "");
  }
}

ViewCloud cloud_in(const std::string& path, const ViewOptions& options) {
  const std::filesystem::path file(path);
  const std::string ending = file.extension().string();
  const bool has_points =
      std::ranges::count(kBinaryPoints, ending) > 0 || std::ranges::count(kTextPoints, ending) > 0;
  ViewCloud cloud = has_points         ? cloud_of(read_point_file(path).scan)
                    : ending == ".npz" ? saved_map_in(path)
                                       : scan_of(path, options);
  if (cloud.points_m.empty()) {
    throw Error("{}: expected points to look at, found none; give another file", path);
  }
  cloud.name = (file.parent_path().filename() / file.filename()).string();
  return cloud;
}

}  // namespace

void declare(CLI::App& app, ViewOptions& options) {
  add_command(
      app, "view", "A page on which maps and scans can be turned, for any browser",
      "The page needs no other file and no network. Large maps are thinned evenly to the number\n"
      "of points that a page may have. Of several files one is shown at a time.")
      .option("FILE", &options.files,
              "Maps and scans: .pcd, .ply, .bin, .txt or .csv points, a saved_map.npz, or a "
              "recording (as for hqslam run), of which a scan is shown",
              {.required = true, .given = Given::kFileOrFolder})
      .option("--sensor", &options.sensor,
              "Sensor of the recordings (name or .json file); default: their own")
      .option("--scan", &options.scan, "Index of the scan of each recording, from 0",
              {.shows_default = true, .given = Given::kNotNegative})
      .option("--out", &options.out, "Page to write", {.required = true});
}

int run(const ViewOptions& options) {
  guard_output_file(options.out, options.files, page_marker("hqslam view"));
  TurningView view;
  std::size_t points = 0;
  for (const std::string& path : options.files) {
    view.clouds.push_back(cloud_in(path, options));
    points += view.clouds.back().points_m.size();
  }
  write_text_file(
      page_html("view", {{"title", view.clouds.front().name}, {"view", turning_view_json(view)}}),
      options.out);
  to_stdout("{} points\nresults: {}\n", points, options.out);
  return kOk;
}

}  // namespace hqslam::tools

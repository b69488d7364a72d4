#include "report/turning_view.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <numeric>

#include "report/cloud_picture.h"
#include "report/point_blocks.h"

namespace hqslam::tools {

const char* const kTurningViewStyle = R"css(
.turning-view { margin: 1rem 0; }
.turning-view .stage { position: relative; aspect-ratio: 16 / 9; background: #11141c; border-radius: 8px; overflow: hidden; }
.turning-view canvas { width: 100%; height: 100%; display: block; touch-action: none; cursor: grab; outline-offset: -2px; }
.turning-view .over { position: absolute; bottom: .7rem; color: #e4e7eb; font-size: .8rem; pointer-events: none; text-shadow: 0 0 4px #000; }
.turning-view .scale { left: .9rem; }
.turning-view .scale i { display: block; height: 4px; border: 2px solid; border-top: 0; }
.turning-view .key { right: .9rem; display: flex; gap: .5rem; align-items: center; }
.turning-view .key i { width: 7rem; height: .55rem; border-radius: 3px; }
.turning-view .controls { display: flex; flex-wrap: wrap; gap: .4rem .9rem; align-items: center; padding: .5rem 0 0; font-size: .85rem; }
.turning-view label { display: flex; gap: .35rem; align-items: center; }
.turning-view label i { width: .7rem; height: .7rem; border-radius: 50%; }
.turning-view button, .turning-view select { font: inherit; color: inherit; background: var(--panel); border: 1px solid var(--rule); border-radius: 6px; padding: .15rem .55rem; }
.turning-view .full { position: absolute; top: .7rem; right: .7rem; color: #e4e7eb; background: #11141cc0; border-color: #4a505c; font-size: .8rem; }
.turning-view button:hover { border-color: var(--quiet); }
.turning-view .scan { flex: 1; min-width: 8rem; }
.turning-view output { min-width: 9rem; font-variant-numeric: tabular-nums; }
.turning-view figcaption { padding-top: .3rem; }
.turning-view:not(.drawn) > :not(.without), .turning-view.drawn > .without, .turning-view [hidden] { display: none; }
.turning-view:fullscreen { margin: 0; padding: .6rem; background: var(--page); display: flex; flex-direction: column; }
.turning-view:fullscreen .stage { flex: 1; min-height: 0; aspect-ratio: auto; }
)css";

namespace {

using Json = nlohmann::ordered_json;
using Points = std::vector<Eigen::Vector3f>;

/// To millimetres.
Json rounded(double value) { return std::round(value * 1e3) / 1e3; }
Json json_of(const Eigen::Vector3d& place_m) {
  return {rounded(place_m.x()), rounded(place_m.y()), rounded(place_m.z())};
}
Json json_of(const Eigen::Vector3f& place_m) {
  return json_of(Eigen::Vector3d(place_m.cast<double>()));
}

/// From the dimmest to the brightest of the points, but for the few beyond; nothing where no
/// intensity is known.
std::vector<float> range_of_intensities(std::vector<float> intensity) {
  constexpr double kBeyond = 0.02;
  std::erase_if(intensity, [](float value) { return !std::isfinite(value); });
  if (intensity.empty()) return {};
  const auto at = [&](double share) {
    const auto place =
        intensity.begin() + std::lround(share * static_cast<double>(intensity.size() - 1));
    std::nth_element(intensity.begin(), place, intensity.end());
    return *place;
  };
  return {at(kBeyond), at(1.0 - kBeyond)};
}

Json json_of(const ViewCloud& cloud, std::size_t most_points) {
  const std::vector<float> bright = range_of_intensities(cloud.intensity);
  std::vector<float> brightness;
  if (!bright.empty()) {
    for (const float intensity : cloud.intensity) {
      brightness.push_back((intensity - bright[0]) / std::max(bright[1] - bright[0], 1e-6F));
    }
  }
  const PointBlocks packed =
      point_blocks(cloud.points_m, cloud.confidence, most_points, brightness);
  Json blocks = Json::array();
  for (const PointBlocks::Block& block : packed.blocks) {
    Json& entry = blocks.emplace_back(Json{block.corner.x(), block.corner.y(), block.corner.z()});
    for (const std::uint32_t end : block.ends) entry.push_back(end);
  }
  std::vector<std::uint8_t> bytes(packed.points.size() * sizeof(std::uint32_t));
  if (!bytes.empty()) std::memcpy(bytes.data(), packed.points.data(), bytes.size());
  return {{"name", cloud.name},
          {"sure", !cloud.confidence.empty()},
          {"bright", bright},
          {"brightness", base64(packed.brightness)},
          {"origin", json_of(packed.origin_m)},
          {"step", packed.step_m},
          {"spacing", packed.spacing_m},
          {"blocks", std::move(blocks)},
          {"points", base64(bytes)}};
}

/// How much of the room each cloud gets, so that none has less than its part of it unless it needs
/// less.
std::vector<std::size_t> shared_out(std::size_t room, const std::vector<std::size_t>& wanted) {
  std::vector<std::size_t> by_size(wanted.size());
  std::iota(by_size.begin(), by_size.end(), 0U);
  std::ranges::sort(by_size, {}, [&](std::size_t i) { return wanted[i]; });
  std::vector<std::size_t> result(wanted.size());
  std::size_t left = wanted.size();
  for (const std::size_t i : by_size) {
    result[i] = std::min(wanted[i], room / left--);
    room -= result[i];
  }
  return result;
}

/// Around the path, or where there is none around most of the points.
Eigen::AlignedBox3d scene_of(const TurningView& view, const Points& points_m) {
  constexpr double kAroundPath_m = 15.0;
  Eigen::AlignedBox3d box;
  for (const Points& piece : view.path_m) {
    for (const Eigen::Vector3f& place_m : piece) box.extend(place_m.cast<double>());
  }
  if (!box.isEmpty()) {
    const Eigen::Vector3d margin_m(kAroundPath_m, kAroundPath_m, 0.0);
    return {box.min() - margin_m, box.max() + margin_m};
  }
  constexpr double kOutliers = 0.05;
  Eigen::Vector3d low, high;
  for (int axis = 0; axis < 3; ++axis) {
    const auto range = range_of(points_m, axis, kOutliers);
    low[axis] = range[0];
    high[axis] = range[1];
  }
  return {low, high};
}

Json json_of(const ViewScan& scan, std::size_t most_points) {
  const Eigen::Vector3d ahead = scan.T_map_sensor.linear().col(0);
  const std::vector<std::size_t> most =
      shared_out(most_points, {scan.measured.points_m.size(), scan.upsampled.points_m.size()});
  return {{"name", scan.name},
          {"number", scan.number},
          {"at", json_of(Eigen::Vector3d(scan.T_map_sensor.translation()))},
          {"yaw", std::atan2(ahead.y(), ahead.x())},
          {"measured", json_of(scan.measured, most[0])},
          {"upsampled", json_of(scan.upsampled, most[1])}};
}

Json data_of(const TurningView& view) {
  static const Points kNone;
  const Points& points_m = !view.clouds.empty()  ? view.clouds.front().points_m
                           : !view.scans.empty() ? view.scans.front().measured.points_m
                                                 : kNone;
  const Eigen::AlignedBox3d scene = scene_of(view, points_m);
  Json data = {{"centre", json_of(Eigen::Vector3d(scene.center()))},
               {"radius", std::max(5.0, 0.5 * scene.sizes().head<2>().norm())},
               {"heights", range_of_heights(points_m)}};
  const auto bytes_of_point = [](const ViewCloud& cloud) {
    return sizeof(std::uint32_t) + (cloud.intensity.empty() ? 0 : 1);
  };
  std::vector<std::size_t> wanted;
  for (const ViewCloud& cloud : view.clouds) {
    wanted.push_back(cloud.points_m.size() * bytes_of_point(cloud));
  }
  const std::vector<std::size_t> most =
      shared_out(kMostCloudPoints * sizeof(std::uint32_t), wanted);
  data["clouds"] = Json::array();
  for (std::size_t i = 0; i < most.size(); ++i) {
    const ViewCloud& cloud = view.clouds[i];
    data["clouds"].push_back(json_of(cloud, most[i] / bytes_of_point(cloud)));
  }
  data["path"] = Json::array();
  for (const Points& piece_m : view.path_m) {
    Json& piece = data["path"].emplace_back(Json::array());
    for (const Eigen::Vector3f& place_m : piece_m) piece.push_back(json_of(place_m));
  }
  data["loops"] = Json::array();
  for (const auto& [from_m, to_m] : view.loops_m) {
    data["loops"].push_back({json_of(from_m), json_of(to_m)});
  }
  data["scans"] = Json::array();
  for (const ViewScan& scan : view.scans) {
    data["scans"].push_back(json_of(scan, kMostScanPoints / view.scans.size()));
  }
  return data;
}

/// As a script's contents: nothing in it ends the script.
std::string script_text(const std::string& json) {
  std::string text;
  for (const char c : json) text += c == '<' ? std::string("\\u003c") : std::string(1, c);
  return text;
}

constexpr const char* kStage = R"html(<figure class="turning-view">
<p class="without quiet">The view that turns needs a browser with WebGL 2 and JavaScript.</p>
<div class="stage"><canvas tabindex="0" aria-label="Points in three dimensions"></canvas>
<button class="full">Full screen</button>
<div class="over scale"><span></span><i></i></div>
<div class="over key"><span class="low"></span><i></i><span class="high"></span></div></div>
)html";

constexpr const char* kScanControls = R"html(<div class="controls"{}>
<button class="play">Play</button><input type="range" class="scan" min="0" value="0" aria-label="Scan"><output></output>
<label><input type="checkbox" class="measured" checked><i style="background:#ffd24a"></i>measured</label>
<label{}><input type="checkbox" class="upsampled" checked><i style="background:#35c3f3"></i>upsampled</label>
</div>
)html";

}  // namespace

std::string turning_view_data(const TurningView& view) {
  return data_of(view).dump(-1, ' ', /*ensure_ascii=*/true, Json::error_handler_t::replace);
}

std::string turning_view_html(const TurningView& view) {
  const auto hidden_unless = [](bool is_there) { return is_there ? "" : " hidden"; };
  const bool upsamples = std::ranges::any_of(
      view.scans, [](const ViewScan& scan) { return !scan.upsampled.points_m.empty(); });
  std::string html = kStage;
  html += fmt::format(
      "<div class=\"controls\">\n"
      "<label{}>Points <select class=\"cloud\"></select></label>\n"
      "<label>Colour <select class=\"colour\"><option>height</option><option>confidence</option>"
      "<option>intensity</option></select></label>\n"
      "<button data-view=\"overview\">Overview</button><button data-view=\"above\">From above"
      "</button><button data-view=\"behind\"{}>Behind the sensor</button>\n"
      "<label{}><input type=\"checkbox\" class=\"map\" checked>map</label>\n"
      "<label{}><input type=\"checkbox\" class=\"way\" checked><i style=\"background:#ff7a5c\"></i>"
      "path</label>\n<label{}><i style=\"background:#d58cff\"></i>loops</label></div>\n",
      hidden_unless(view.clouds.size() > 1), hidden_unless(!view.scans.empty()),
      hidden_unless(!view.scans.empty()), hidden_unless(!view.path_m.empty()),
      hidden_unless(!view.loops_m.empty()));
  html += fmt::format(fmt::runtime(kScanControls), hidden_unless(!view.scans.empty()),
                      hidden_unless(upsamples));
  html +=
      "<figcaption>Drag to turn, Shift or right button to move, wheel to zoom (click first); two "
      "fingers move and zoom; arrow keys, + and -.</figcaption>\n<script "
      "type=\"application/json\">";
  html += script_text(turning_view_data(view));
  html += "</script>\n</figure>\n<script>";
  html += kTurningViewScript;
  return html + "</script>\n";
}

}  // namespace hqslam::tools

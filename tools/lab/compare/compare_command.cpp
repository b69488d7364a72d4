#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "compare/confidence_curve.h"
#include "compare/tulip_comparison.h"
#include "compare/upsampling_comparison.h"
#include "files/result_files.h"
#include "hqslam/core/error.h"
#include "hqslam/nn/compare/compared_networks.h"
#include "lab_commands.h"
#include "recording/reading.h"
#include "recording/recording_choice.h"
#include "recording/scan_poses.h"
#include "report/page.h"
#include "terminal/command_options.h"
#include "terminal/progress.h"
#include "terminal/terminal.h"
#include "upsample/drive_memory.h"
#include "upsample/upsampled_input.h"

namespace hqslam::tools {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kMeasuredRows = 16;

void guard_outputs(const CompareOptions& options) {
  Paths inputs = options.weights;
  inputs.push_back(options.input);
  if (!options.json.empty()) guard_output_file(options.json, inputs, kCompareJsonMarker);
  if (!options.curve.empty()) guard_output_file(options.curve, inputs, kConfidencePageMarker);
}

/// There must be rows between the measured ones.
void require_rows_to_compute(const CompareOptions& options, const SensorModel& sensor) {
  if (sensor.rows() > kMeasuredRows) return;
  throw Error(
      "{}: is of sensor '{}' with {} rows, expected more than the {} that are measured; give a "
      "recording with all rows",
      options.input, sensor.name, sensor.rows(), kMeasuredRows);
}

/// The network of a weights file, if it is for scans such as the sensor's.
nn::SuperResolver network_of(const std::string& weights, const SensorModel& sensor,
                             nn::SuperResolverOptions options = {}) {
  options.architectures = nn::all_architectures();
  nn::SuperResolver network = nn::SuperResolver::load(weights, options);
  const SensorModel& made_for = network.sensor();
  if (!fits(sensor, made_for)) {
    throw Error(
        "{}: upsamples scans of '{}' ({} x {}, beams within {} degrees), but the recording is of "
        "'{}' "
        "({} x {}); give weights made for that sensor",
        weights, made_for.name, made_for.rows(), made_for.columns, kBeamTolerance_deg, sensor.name,
        sensor.rows(), sensor.columns);
  }
  return network;
}

/// The network without the filter at its end.
nn::Upsampler without_last_filter(const std::string& weights, const SensorModel& sensor) {
  return {network_of(weights, sensor, {.filter_result = false}), sensor};
}

std::vector<ComparedMethod> methods_of(const CompareOptions& options, const SensorModel& sensor) {
  const RowSelection rows = selection_for(sensor.rows(), kMeasuredRows);
  std::vector<ComparedMethod> methods;
  for (const std::string& name : nn::interpolation_names()) {
    methods.push_back({name, {nn::interpolation_from_name(name), sensor, rows}});
  }
  std::vector<nn::Upsampler> networks;
  for (const std::string& weights : options.weights) {
    networks.emplace_back(network_of(weights, sensor), sensor);
  }
  std::vector<std::string> kinds;
  for (const nn::Upsampler& network : networks) kinds.push_back(network.name());
  for (std::size_t i = 0; i < networks.size(); ++i) {
    nn::Upsampler& network = networks[i];
    const std::string& weights = options.weights[i];
    const bool is_alone = std::ranges::count(kinds, kinds[i]) == 1;
    const std::string name = is_alone ? kinds[i] : short_name(weights, options.weights);
    if (last_filter(network.network()->description())) {
      methods.push_back({name + ", unfiltered at the end", without_last_filter(weights, sensor)});
      methods.push_back({name, std::move(network), without_last_filter(weights, sensor)});
    } else {
      methods.push_back({name, std::move(network)});
    }
  }
  return methods;
}

using ScoreFigures = std::vector<Figure<UpsamplingScore>>;

/// Others are held against linear's, or the first where that is not there.
ScoreFigures score_figures(const std::vector<UpsamplingScore>& scores) {
  const auto found = std::ranges::find(scores, "linear", &UpsamplingScore::method);
  const UpsamplingScore linear = found != scores.end() ? *found : scores.front();
  using S = UpsamplingScore;
  return {
      {"MAE all m", "mae_all_m", 3, 1.0, &S::mae_all_m},
      {"of linear", nullptr, 3, 1.0, [=](const S& s) { return s.mae_all_m / linear.mae_all_m; }},
      {"MAE valid m", "mae_valid_m", 3, 1.0, &S::mae_valid_m},
      {"missing %", "missing_share", 2, 100.0, &S::missing_share},
      {"invented %", "invented_share", 2, 100.0, &S::invented_share},
      {"right %", "right_share", 2, 100.0, &S::right_share},
      {"Chamfer m^2", "chamfer_m2", 3, 1.0, &S::chamfer_m2},
      {"IoU", "iou", 3, 1.0, &S::iou},
      {"precision", "precision", 3, 1.0, &S::precision},
      {"recall", "recall", 3, 1.0, &S::recall},
      {"F1", "f1", 3, 1.0, &S::f1},
      {"computed", "computed_f1", 3, 1.0, &S::computed_f1},
      {"outliers %", "outlier_share", 2, 100.0, &S::outlier_share},
      {"per scan", "outliers_per_scan", 0, 1.0, &S::outliers_per_scan},
      {"of linear", nullptr, 3, 1.0,
       [=](const S& s) { return s.outliers_per_scan / linear.outliers_per_scan; }},
      {"good lost %", "good_lost_share", 2, 100.0, &S::good_lost_share},
      {"ms", nullptr, 2, 1.0,
       [](const S& s) {
         return s.upsampling_ms > 0.0 ? std::optional(s.upsampling_ms) : std::nullopt;
       }},
      {nullptr, "upsampling_ms", 0, 1.0, &S::upsampling_ms}};
}

void print_scores(const std::vector<UpsamplingScore>& scores) {
  to_stdout("{}", markdown_of(table_of(scores, "method", score_figures(scores),
                                       [](const auto& score) { return score.method; })));
}

void print_trials(const std::vector<FilterTrial>& trials) {
  using T = FilterTrial;
  const auto share = [](std::int64_t part, std::int64_t whole) {
    return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0.0;
  };
  const std::vector<Figure<T>> figures = {
      {"angle deg", nullptr, 0, 1.0, &T::min_angle_deg},
      {"min pixels", nullptr, 0, 1.0, &T::min_pixels},
      {"bad removed %", nullptr, 1, 100.0, [=](const T& t) { return share(t.bad_removed, t.bad); }},
      {"good lost %", nullptr, 2, 100.0, [=](const T& t) { return share(t.good_lost, t.good); }},
      {"outliers left %", nullptr, 2, 100.0,
       [=](const T& t) { return share(t.bad - t.bad_removed, t.points_left); }},
      {"MAE all m", nullptr, 3, 1.0,
       [](const T& t) { return t.mae_sum_m / static_cast<double>(t.scans); }}};
  const auto support = [](const T& t) { return fmt::format("{:.0f}", 100.0 * t.support_share); };
  to_stdout("{}", markdown_of(table_of(trials, "support %", figures, support)));
}

Json scores_json(const std::vector<UpsamplingScore>& scores) {
  const ScoreFigures figures = score_figures(scores);
  Json json = Json::array();
  for (const UpsamplingScore& score : scores) {
    Json& row = json.emplace_back(Json{{"method", score.method}});
    add_figures(score, figures, row);
  }
  return json;
}

/// The curve of the last weights, if it was asked for.
std::optional<ConfidenceCurve> curve_of(const CompareOptions& options, const SensorModel& sensor) {
  if (options.curve.empty()) return std::nullopt;
  if (options.weights.empty()) throw Error("compare: --curve needs --weights");
  return ConfidenceCurve(nn::Upsampler(network_of(options.weights.back(), sensor,
                                                  {.filter_result = false,
                                                   .tolerance_m = options.tolerance_m,
                                                   .least_confidence = 0.0F}),
                                       sensor),
                         options.tolerance_m);
}

Json curve_json(const ConfidenceCurve& curve) {
  Json points = Json::array();
  for (const OperatingPoint& point : curve.points()) {
    Json& json = points.emplace_back(Json{{"least_confidence", point.least_confidence}});
    add_figures(point, operating_figures(), json);
  }
  Json bins = Json::array();
  for (const ReliabilityBin& bin : curve.reliability()) {
    bins.push_back(
        {{"confidence", bin.confidence}, {"right_share", bin.right_share}, {"pixels", bin.pixels}});
  }
  return {
      {"points", points}, {"reliability", bins}, {"calibration_error", curve.calibration_error()}};
}

void finish_curve(const ConfidenceCurve& curve, const CompareOptions& options) {
  write_text_file(confidence_html(curve, options.weights.back(), options.input), options.curve);
  to_stdout("{}confidence against what was right: {:.3f} off on average; page: {}\n",
            markdown_of(operating_table(curve.points())), curve.calibration_error(), options.curve);
}

/// Hands every `every`-th scan of the recording to `use`, with what a memory for `upsampler` has of
/// the scans before and after it. Returns how many.
template <typename Use>
std::int64_t for_each_scan(const CompareOptions& options, const SensorModel& sensor,
                           const InterruptGuard& interrupt, const Use& use,
                           const nn::Upsampler* upsampler = nullptr) {
  require_memory(options.poses, upsampler);
  const ScanPoses poses =
      read_scan_poses(options.poses, interrupt, [&] { return open_input(options, sensor); });
  const auto measured_of = [&](const OrganizedCloud& truth) {
    return select_rows(truth, selection_for(truth.rows, kMeasuredRows));
  };
  const auto remembered = [&](const RecordedScan& scan) {
    return measured_of(calibrated(scan.cloud, sensor));
  };
  LookAheadMemory memory(upsampler, poses, remembered, !options.no_look_ahead);
  const auto source = open_input(options, sensor);
  const std::size_t told = print_warnings(*source, options.input);
  Progress progress("compare", source->size());
  std::int64_t used = 0;
  std::int64_t looked_at = 0;
  Reading reading;
  const auto compare = [&](const ReadScan& read) {
    progress.update(++looked_at, source->read_share());
    const OrganizedCloud truth = calibrated(read.scan.cloud, sensor);
    const OrganizedCloud measured = measured_of(truth);
    const nn::RecalledImage recalled = memory.recall(read, measured);
    if ((looked_at - 1) % options.every != 0) return true;
    if (points_of(measured).empty()) throw ScanError("has no return in the measured rows");
    use(truth, recalled);
    ++used;
    return true;
  };
  read_scans(*source, interrupt, reading, compare, memory.look_ahead());
  progress.finish();
  print_later_warnings(*source, told);
  if (reading.end == ReadingEnd::kUnreadableScan) throw Error(reading.end_message);
  if (used == 0 && reading.left_out.scans > 0 && reading.end == ReadingEnd::kComplete) {
    throw Error(reading.left_out.text());
  }
  if (reading.left_out.scans > 0) to_stderr("hqslam: {}\n", reading.left_out.text());
  memory.tell_of_scans_without_pose(options.poses, options.input);
  return used;
}

}  // namespace

void declare(CLI::App& app, CompareOptions& options) {
  Command command = add_command(
      app, "compare", "Compare ways to upsample 16 rows to all against a recording that has all",
      R"(Rows: nearest, linear and inverse (linear in 1/range, by the beams' elevations)
interpolation, and each network, by its kind or, where several are of that kind, its file: with
its filters, and where it has one at its end, without that one (the filters inside stay).
Missing: share of the true returns between the measured rows that are left empty; invented:
share of the computed points where the truth has no return; right: share of those true returns
that are met within 0.1 m. Precision, recall, F1: voxels of 0.1 m; computed: F1 without the
measured rows. Outliers are farther than 0.5 m from the true cloud, good points nearer than
0.2 m.
With --layers: H (measured rows and what was believed before), Z (denoiser) and Y (inner
filter) of every layer as if the network ended there.)");
  declare_input(command, options, "Recording with all rows (as for hqslam run)");
  command.option("--weights", &options.weights, "Weights files to compare", {.given = Given::kFile})
      .option("--poses", &options.poses, kMemoryPosesHelp, {.given = Given::kFile})
      .option("--no-look-ahead", &options.no_look_ahead,
              "Remember only the scans before each, as run and live do while SLAM is on its way",
              {.needs = {"--poses"}})
      .option("--every", &options.every, "Take every n-th scan (default: all)",
              {.within = kAnyCount})
      .option(
          "--curve", &options.curve,
          "Also write a page about the confidence of the last weights (du-mix): every operating "
          "point, and whether it can be believed")
      .option("--tolerance", &options.tolerance_m,
              "With --curve: how far off in metres a range may be and count as right; with 100 and "
              "more it is the confidence that there is a return at all",
              {.shows_default = true, .within = kTolerance_m, .needs = {"--curve"}})
      .option("--filters", &options.filters,
              "Instead, try settings of the outlier filter on the first weights' results",
              {.excludes = {"--curve"}})
      .option("--layers", &options.layers,
              "Instead, score what each step of the first weights' layers makes of the scans",
              {.excludes = {"--filters", "--curve"}})
      .option("--json", &options.json, "Also write the table into this file",
              {.excludes = {"--filters", "--layers"}})
      .option("--protocol", &options.protocol,
              "tulip: project KITTI .bin files, upsample and score them as the code of TULIP does",
              {.shows_default = true,
               .one_of = {"own", "tulip"},
               .excludes = {"--filters", "--layers"}});
  declare_threads(command, options.threads);
}

int run(const CompareOptions& options) {
  use_threads(options.threads);
  guard_outputs(options);
  if (options.protocol == "tulip") return compare_with_tulip(options);
  const InterruptGuard interrupt;
  const SensorModel sensor = required_recording_sensor(options);
  require_rows_to_compute(options, sensor);
  Json json;
  std::int64_t used = 0;
  if ((options.filters || options.layers) && options.weights.empty()) {
    throw Error("compare: {} needs --weights", options.filters ? "--filters" : "--layers");
  }
  if (options.filters) {
    FilterComparison comparison(without_last_filter(options.weights.front(), sensor));
    used = for_each_scan(options, sensor, interrupt,
                         [&](const OrganizedCloud& scan, const auto&) { comparison.add(scan); });
    print_trials(comparison.trials());
  } else if (options.layers) {
    LayerComparison comparison(network_of(options.weights.front(), sensor), sensor);
    used = for_each_scan(options, sensor, interrupt,
                         [&](const OrganizedCloud& scan, const auto&) { comparison.add(scan); });
    print_scores(comparison.scores());
  } else {
    UpsamplingComparison comparison(methods_of(options, sensor));
    std::optional<ConfidenceCurve> curve = curve_of(options, sensor);
    used = for_each_scan(
        options, sensor, interrupt,
        [&](const OrganizedCloud& scan, const nn::RecalledImage& recalled) {
          comparison.add(scan, recalled);
          if (curve) curve->add(scan, recalled);
        },
        comparison.with_memory());
    if (used == 0 && interrupt.stop_requested()) return kInterrupted;
    print_scores(comparison.scores());
    to_stdout(
        "chance in the data: the median of the eight true ranges around each pixel has an MAE "
        "of {:.3f} m\n",
        comparison.true_neighbours_mae_m());
    json = {{"written_by", "hqslam-lab compare"},
            {"input", options.input},
            {"sensor", sensor.name},
            {"scans", used},
            {"true_neighbours_mae_all_m", comparison.true_neighbours_mae_m()},
            {"methods", scores_json(comparison.scores())}};
    if (curve && used > 0) {
      json["curve"] = curve_json(*curve);
      finish_curve(*curve, options);
    }
  }
  to_stdout("{} scans of {}\n", used, options.input);
  if (!options.json.empty()) {
    write_text_file(json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n", options.json);
  }
  return interrupt.stop_requested() ? kInterrupted : kOk;
}

}  // namespace hqslam::tools

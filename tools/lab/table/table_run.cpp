#include <omp.h>

#include <fstream>
#include <limits>
#include <optional>
#include <utility>

#include "compare/upsampling_comparison.h"
#include "hqslam/core/error.h"
#include "hqslam/nn/compare/compared_networks.h"
#include "hqslam/nn/hqs/outlier_removal.h"
#include "hqslam/nn/instruction_set.h"
#include "hqslam/nn/upsampled_cloud.h"
#include "hqslam/pipeline/drive_memory.h"
#include "hqslam/pipeline/pipeline.h"
#include "recording/reading.h"
#include "table/table_work.h"
#include "timing/timing.h"

namespace hqslam::tools {
namespace {

/// The processor's name, "unknown processor" where the system has none.
std::string processor_name() {
  std::ifstream stream("/proc/cpuinfo");
  for (std::string line; std::getline(stream, line);) {
    const std::size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown processor";
}

/// What the pass's methods have in common: nothing fills the rows where they see them as recorded,
/// and no network's last filter runs.
pipeline::UpsampledRecording shared_input(const DriveWork& work, const TableMethod& method) {
  const std::string weights = weights_of(method, work.sensor.name);
  pipeline::UpsamplingOptions upsampling{weights.empty() ? method.source : weights, method.rows};
  upsampling.network.filter_result = false;
  upsampling.network.architectures = nn::all_architectures();
  const InputChoice& recording = work.drive.recording;
  return pipeline::open_upsampled(recording.input, open_options(recording), upsampling);
}

std::optional<nn::OutlierRemoval> filter_of(const TableMethod& method,
                                            const nn::Upsampler* upsampler) {
  if (!method.filtered) return std::nullopt;
  const nn::NetworkDescription& network = upsampler->network()->description();
  const std::optional<nn::OutlierRemovalOptions> filter = last_filter(network);
  if (!filter) return std::nullopt;  // the network has no filter at its end
  return nn::OutlierRemoval(network.sensor, network.measured_rows, *filter, network.sensor.columns);
}

/// SLAM with its times.
struct TimedSlam {
  explicit TimedSlam(const SlamSetup& setup) : system(setup.sensor, setup.options) {}

  void add(const OrganizedCloud& cloud, double stamp_s) {
    const slam::ScanReport report = system.process(cloud, stamp_s).report;
    times_ms.push_back(1e3 * report.times.total_s);
    is_located = slam::is_registered(report.mapping_status);
    count(report.loop);
  }

  void finish() {
    for (const slam::LoopReport& loop : system.finish()) count(loop);
  }

  SlamTimings timings() const {
    SlamTimings timings;
    for (const double time_ms : times_ms) timings.total_s += 1e-3 * time_ms;
    if (times_ms.size() >= 2 * kTimedEnds) {
      constexpr auto kEnd = static_cast<std::ptrdiff_t>(kTimedEnds);
      timings.first_ms = distribution_of({times_ms.begin(), times_ms.begin() + kEnd}).median;
      timings.last_ms = distribution_of({times_ms.end() - kEnd, times_ms.end()}).median;
    }
    return timings;
  }

  void count(const slam::LoopReport& loop) {
    loops_closed += loop.status == slam::LoopStatus::kClosed ? 1 : 0;
  }

  pipeline::Pipeline system;
  std::vector<double> times_ms = {};
  bool is_located = false;  ///< the last scan
  std::int64_t loops_closed = 0;
};

/// The run of one method over the drive.
class MethodRun {
 public:
  MethodRun(const TableRun& run, const pipeline::Upsampler& upsampler)
      : filter_(filter_of(run.method, upsampler.method())) {
    result_.method = run.method;
    result_.settings = run.settings;
    slam_.emplace_back(slam_setup(run.method, upsampler.sensor(), false));
    if (run.settings.loop_closing) {
      slam_.emplace_back(slam_setup(run.method, upsampler.sensor(), true));
    }
  }

  /// A cloud for SLAM.
  void add(const OrganizedCloud& cloud, double stamp_s) {
    for (TimedSlam& slam : slam_) slam.add(cloud, stamp_s);
  }

  /// upsampled: all rows, before the filter; shared_s: the time of upsampling. scored: compare with
  /// `truth`.
  void add_upsampled(nn::UpsampledImage upsampled, double shared_s, const OrganizedCloud& measured,
                     const nn::Upsampler& upsampler, const RecordedScan& truth, bool scored) {
    const double filter_s = filter_ ? seconds_of([&] { remove_outliers(upsampled.image); }) : 0.0;
    upsampling_ms_.push_back(1e3 * (shared_s + filter_s));
    result_.timings.upsampling_s += shared_s + filter_s;
    OrganizedCloud cloud;
    result_.timings.points_s += seconds_of([&] {
      cloud =
          nn::upsampled_cloud(upsampled, measured, upsampler.measured_rows(), upsampler.sensor());
    });
    add(cloud, truth.stamp_s);
    // A scan without measured returns is not scored.
    if (scored && !points_of(measured).empty()) score(upsampled.image, cloud, truth.cloud);
  }

  /// Without loop closing.
  const TimedSlam& slam() const { return slam_.front(); }

  /// To be called once, at the end. network: what upsamples, nullptr without one.
  TableResult result(const nn::SuperResolver* network) {
    if (result_.images) {
      const auto scans = static_cast<double>(result_.images->scans);
      result_.images->mae_all_m /= scans;
      result_.images->mae_valid_m /= scans;
      result_.images->outlier_share /= scans;
    }
    if (network != nullptr) {
      result_.network = NetworkSize{network->parameters(), network->multiply_adds()};
    }
    TableTimings& timings = result_.timings;
    timings.upsampling_ms = distribution_of(upsampling_ms_).median;
    timings.threads = omp_get_max_threads();
    timings.processor = processor_name();
    timings.instruction_set = nn::name(nn::chosen_instruction_set());
    for (std::size_t i = 0; i < slam_.size(); ++i) {
      slam_[i].finish();
      result_.trajectory[i] = slam_[i].system.trajectory();
      timings.slam[i] = slam_[i].timings();
      result_.loops_closed += slam_[i].loops_closed;
    }
    return result_;
  }

 private:
  void remove_outliers(RangeImage& image) {
    rejected_.resize(image.range_m.size());
    filter_->find(image.range_m.data(), rejected_.data(), omp_get_max_threads());
    for (std::size_t i = 0; i < rejected_.size(); ++i) {
      image.range_m[i] = rejected_[i] != 0 ? 0.0F : image.range_m[i];
    }
  }

  void score(const RangeImage& upsampled, const OrganizedCloud& cloud,
             const OrganizedCloud& truth) {
    const ScanErrors errors = scan_errors(upsampled, cloud, truth);
    if (!result_.images) result_.images = ImageScores();
    ++result_.images->scans;
    result_.images->mae_all_m += errors.image.mae_all_m;
    result_.images->mae_valid_m += errors.image.mae_valid_m;
    result_.images->outlier_share += errors.cloud.outlier_share;
  }

  std::optional<nn::OutlierRemoval> filter_;
  std::vector<std::uint8_t> rejected_;
  std::vector<TimedSlam> slam_;  ///< without and, if asked for, with loop closing
  std::vector<double> upsampling_ms_;
  TableResult result_;  ///< of images sums, until result() divides them
};

/// The pass's state while it runs.
class Pass {
 public:
  Pass(const DriveWork& work, const TablePass& pass, std::int64_t scored_scans)
      : input_(shared_input(work, pass.front().method)),
        memory_(upsampler().method()),
        score_every_((work.scans + scored_scans - 1) / scored_scans) {
    for (const TableRun& run : pass) runs_.emplace_back(run, upsampler());
  }

  recordings::Recording& recording() { return input_.recording; }

  void add(const RecordedScan& scan, std::int64_t index) {
    const OrganizedCloud measured = upsampler().measured(scan.cloud);
    nn::Upsampler* method = upsampler().method();
    if (method == nullptr) {
      for (MethodRun& run : runs_) run.add(measured, scan.stamp_s);
      return;
    }
    const RangeImage image = range_image(measured);
    nn::UpsampledImage upsampled;
    const double shared_s = seconds_of([&] {
      upsampled = method->run(
          image, memory_.recall(measured, runs_.front().slam().system.trajectory(), scan.stamp_s));
    });
    for (MethodRun& run : runs_) {
      run.add_upsampled(upsampled, shared_s, measured, *method, scan, index % score_every_ == 0);
    }
    // At the pose of the first method of the pass.
    const TimedSlam& slam = runs_.front().slam();
    memory_.insert(measured, slam.system.trajectory(), slam.is_located);
  }

  std::vector<TableResult> results(const std::vector<std::int64_t>& scan_of_pose,
                                   const LeftOut& left_out) {
    const nn::Upsampler* method = upsampler().method();
    std::vector<TableResult> results;
    for (MethodRun& run : runs_) {
      TableResult& result =
          results.emplace_back(run.result(method != nullptr ? method->network() : nullptr));
      result.scan_of_pose = scan_of_pose;
      result.left_out = left_out;
    }
    return results;
  }

 private:
  pipeline::Upsampler& upsampler() { return input_.upsampler; }

  pipeline::UpsampledRecording input_;
  pipeline::DriveMemory memory_;
  std::int64_t score_every_;
  std::vector<MethodRun> runs_;
};

/// SLAM works with a clock that is set back; a comparison of trajectories by stamps does not.
void require_rising(const RecordedScan& scan, double last_stamp_s) {
  if (scan.stamp_s > last_stamp_s) return;
  throw Error(
      "{}: expected a stamp after that of the scan before, {:.6f} s, found {:.6f} s; give rising "
      "stamps with --stamps",
      scan.name, last_stamp_s, scan.stamp_s);
}

}  // namespace

std::vector<TableResult> run_pass(const DriveWork& work, const TablePass& pass,
                                  std::int64_t scored_scans, const InterruptGuard& interrupt,
                                  const std::function<void()>& on_scan) {
  Pass state(work, pass, scored_scans);
  Reading reading;
  std::vector<std::int64_t> scan_of_pose;
  double last_stamp_s = -std::numeric_limits<double>::infinity();
  read_scans(state.recording(), interrupt, reading, [&](const ReadScan& read) {
    require_rising(read.scan, last_stamp_s);
    last_stamp_s = read.scan.stamp_s;
    // SLAM checks the point times first, so a scan that it leaves out does not change its state.
    state.add(read.scan, std::ssize(scan_of_pose));
    scan_of_pose.push_back(read.index);
    on_scan();
    return std::ssize(scan_of_pose) < work.scans;
  });
  if (reading.end == ReadingEnd::kInterrupted) return {};
  if (reading.end == ReadingEnd::kUnreadableScan) throw Error(reading.end_message);
  return state.results(scan_of_pose, reading.left_out);
}

}  // namespace hqslam::tools

#include "live/live_command.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <vector>

#include "hqslam/core/error.h"
#include "hqslam/evaluation/trajectory_error.h"
#include "hqslam/live/live.h"
#include "live/live_run.h"
#include "live/live_view.h"
#include "live/view_server.h"
#include "pages/open_page.h"
#include "run/run_summary.h"
#include "run/slam_session.h"
#include "terminal/command_options.h"
#include "terminal/terminal.h"

namespace hqslam::tools {
namespace {

constexpr std::uint16_t kViewPort = 8642;

live::LiveOptions sensor_options(const LiveOptions& options) {
  live::LiveOptions sensor;
  sensor.sensor = options.sensor;
  sensor.port = options.port;
  sensor.kept_return = kept_return_named(options.kept_return);
  sensor.record = options.record;
  return sensor;
}

/// Two units of one type may differ from their data sheet by more than weights can bear: for a
/// sensor whose own beams are still unknown, those of the weights are assumed.
void assume_beams(SensorModel& sensor, const pipeline::UpsamplingMethod& method) {
  std::optional<SensorModel> full = pipeline::sensor_of(method);
  if (!full) return;
  const RowSelection rows = *std::exchange(full->measured_rows, std::nullopt);
  for (const SensorModel& expected : {*full, select_rows(*full, rows)}) {
    if (sensor.rows() == expected.rows()) sensor.beam_elevation_rad = expected.beam_elevation_rad;
  }
}

pipeline::Upsampler upsampler_of(const live::NamedSensor& named, const LiveOptions& options,
                                 const std::string& name) {
  const pipeline::UpsamplingOptions upsampling = upsampling_options(options);
  SensorModel sensor = named.sensor;
  pipeline::UpsamplingMethod method = pipeline::load_method(upsampling, sensor);
  if (!named.knows_beams) assume_beams(sensor, method);
  pipeline::Upsampler upsampler(sensor, std::move(method), upsampling, name);
  check_confidence(options, upsampler);
  return upsampler;
}

/// Refuses weights that the sensor cannot be upsampled with before its packets come, as far as it
/// is known then.
void require_possible(const LiveOptions& options) {
  const live::NamedSensor named = live::named_sensor(options.sensor);
  const int columns =
      upsampler_of(named, options, fmt::format("--sensor {}", options.sensor)).recorded().columns;
  if (!named.knows_columns || columns == named.sensor.columns) return;
  throw Error("{}: the sensor sends {} columns a turn, {} expects {}; set it to another mode",
              options.sensor, named.sensor.columns, options.upsample, columns);
}

void print_sensor(const live::LiveSensor& sensor, int columns) {
  for (const std::string& warning : sensor.warnings()) to_stderr("hqslam: {}\n", warning);
  to_stdout("{} from {}: {}, {} rows x {} columns, {:.4g} turns a second\n", sensor.format(),
            text(sensor.sender()), sensor.sensor().name, sensor.sensor().rows(), columns,
            1.0 / sensor.sensor().scan_period_s);
}

/// out: where the results are; empty: they could not be written.
void print_summary(const SlamRun& run, const live::LiveCounts& counts, const std::string& out) {
  std::vector<double> latencies_ms;
  for (const ScanRecord& scan : run.scans) latencies_ms.push_back(1e3 * scan.latency_s.value());
  const Statistics latency = statistics_of(std::move(latencies_ms));
  to_stdout("{}", run_summary(run));
  to_stdout(
      "from the packet that completes a scan to its pose: median {:.1f}, 95 % {:.1f}, "
      "longest {:.1f} ms\n",
      latency.median, latency.p95, latency.max);
  to_stdout("{} packets, {} lost; {} of {} scans dropped; {} inertial samples\n",
            counts.packets.used, counts.packets.lost, counts.dropped_scans, counts.scans,
            counts.imu.used);
  if (!out.empty()) to_stdout("{}", results_lines(run, out));
}

/// The capture that --record writes, as hqslam run would open it.
InputChoice recording_of(const LiveOptions& options) {
  InputChoice recording{options.record};
  recording.kept_return = options.kept_return;
  const auto metadata = std::filesystem::path(options.record).replace_extension(".json");
  if (!std::filesystem::exists(metadata)) recording.sensor = options.sensor;
  return recording;
}

/// Makes the maps that need all poses, from the capture. Ctrl-C, which ended the drive, ends this
/// when it comes again.
void add_maps_of_capture(const LiveOptions& options, RunOutput& output, SlamRun& run) {
  const InterruptGuard interrupt;
  add_maps(recording_of(options), options, options, interrupt, output, run);
}

/// The exit status, with the line on stderr that explains it.
int exit_status_of(const SlamRun& run, const live::LiveCounts& counts, const MapChoice& maps) {
  int status = exit_status_of_maps(maps, run);
  if (status == kOk) status = exit_status_of(run, std::ssize(run.scans), counts.scans);
  if (status != kOk || counts.recording_failure.empty()) return status;
  to_stderr("hqslam: {}; the recording ends there, the results are whole\n",
            counts.recording_failure);
  return kWrongInput;
}

/// After the results, or what of them could be written: maps and the summary. Returns an
/// ExitStatus.
int finish(const LiveOptions& options, const live::LiveCounts& counts, const std::string& failure,
           RunOutput& output, SlamRun& run) {
  if (failure.empty()) add_maps_of_capture(options, output, run);
  print_summary(run, counts, failure.empty() ? options.out : "");
  const int status = exit_status_of(run, counts, options);
  if (failure.empty()) return status;
  to_stderr("hqslam: {}; not all results are written{}\n", failure,
            options.record.empty() ? "" : ", hqslam run makes them of the recording");
  return kWrongInput;
}

}  // namespace

void declare(CLI::App& app, LiveOptions& options) {
  Command command = add_command(
      app, "live", "Make a trajectory and a map from a connected sensor",
      "Set the sensor to send to this computer. A line each second shows the pose, located scans "
      "a second, the longest latency from the packet that completes a scan to its pose, lost "
      "packets, and scans that were dropped because the computer is too slow. Ctrl-C (or SIGTERM) "
      "ends the drive with exit status 0 and the results of hqslam run in --out.");
  command
      .option(
          "--sensor", &options.sensor,
          fmt::format("Sensor: {}, or a .json file (an Ouster's metadata, or the beam angles of "
                      "a Velodyne); the metadata of an Ouster given by name are requested "
                      "over HTTP",
                      fmt::join(sensor_preset_names(), ", ")),
          {.required = true})
      .option("--port", &options.port,
              "UDP port to which the sensor sends (default: that of an Ouster's metadata or 7502, "
              "2368 for a Velodyne)",
              {.within = std::pair(1, 65535)});
  declare_return(command, options.kept_return);
  declare_upsampling(command, options);
  command
      .option("--out", &options.out, "Folder for the results; made if it does not exist",
              {.required = true})
      .option("--record", &options.record,
              "Also record the packets in this .pcap file, with an Ouster's metadata beside it")
      .option("--view", &options.view,
              fmt::format("Serve a page with the growing path and map on this port (without a "
                          "value: {}; 0: any free port)",
                          kViewPort),
              {.within = std::pair(0, 65535), .if_bare = std::to_string(kViewPort)})
      .option("--view-address", &options.view_address,
              "Address at which --view serves its page; the default serves this computer alone",
              {.shows_default = true, .needs = {"--view"}});
  declare_open(command, options.open, {"--view"});
  declare_threads(command, options.threads);
  declare_slam_kind(command, options.slam);
  declare_slam_settings(command, options.slam);
  declare_maps(command, options, {"--record"});
}

int run(const LiveOptions& options) {
  std::optional<InterruptGuard> interrupt(std::in_place);
  use_threads(options.threads);
  const pipeline::PipelineOptions pipeline = pipeline_options(options.slam, options);
  RunOutput output(options.out, {options.sensor, options.upsample, options.map_file});
  require_possible(options);
  std::optional<live::LiveSensor> sensor(std::in_place, sensor_options(options));
  output.prepare();  // a disk that takes nothing is better known before the drive
  LiveView view(fmt::format("hqslam live, {}", options.sensor));
  std::optional<ViewServer> server;
  if (options.view) {
    server.emplace(options.view_address, *options.view,
                   [&view](const std::string& target) { return view.answer(target); });
    to_stdout("page: {}\n", server->url());
    if (options.open) open_page(server->url());
  }
  if (!wait_for_sensor(*sensor, *interrupt)) return kOk;
  const std::string port = fmt::format("UDP port {}", sensor->port());
  pipeline::Upsampler upsampler = upsampler_of({sensor->sensor()}, options, port);
  const int columns = upsampler.recorded().columns;
  print_sensor(*sensor, columns);
  sensor->start(columns);
  if (const std::string failure = sensor->counts().imu_failure; !failure.empty()) {
    to_stderr("hqslam: {}; driving without inertial data\n", failure);
  }
  SlamSession session(std::move(upsampler), pipeline, port);
  session.run().located_in = options.map_file;
  SlamRun run = run_live(*sensor, std::move(session), output, *interrupt, server ? &view : nullptr,
                         options.save_map);
  const live::LiveCounts counts = sensor->counts();
  if (run.scans.empty()) {
    if (run.end == ReadingEnd::kUnreadableScan) throw Error(run.end_message);
    to_stderr("hqslam: interrupted before the first scan; nothing was written\n");
    return kOk;
  }
  sensor.reset();  // which ends its capture
  const std::string failure = failure_of_writing([&] { output.write_results(run); });
  interrupt.reset();
  return finish(options, counts, failure, output, run);
}

}  // namespace hqslam::tools

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <vector>

#include "commands.h"
#include "hqslam/core/error.h"
#include "hqslam/live/live.h"
#include "live/live_run.h"
#include "live/live_view.h"
#include "live/view_server.h"
#include "run/run_plan.h"
#include "run/run_summary.h"
#include "terminal/exit_status.h"
#include "terminal/terminal.h"
#include "timing/timing_statistics.h"

namespace hqslam::tools {
namespace {

constexpr std::uint16_t kViewPort = 8642;

live::LiveOptions sensor_options(const LiveCommandOptions& options) {
  live::LiveOptions sensor;
  sensor.sensor = options.sensor;
  sensor.port = options.port;
  sensor.kept_return = options.kept_return == "last" ? recordings::KeptReturn::kLast
                                                     : recordings::KeptReturn::kStrongest;
  sensor.record = options.record;
  return sensor;
}

/// What the sensor cannot be lifted by is said before its packets come, as far as it is known then.
void require_possible(const LiveCommandOptions& options) {
  const auto [sensor, knows_beams, knows_columns] = live::named_sensor(options.sensor);
  const RunPlan plan =
      plan_of(options, sensor, fmt::format("--sensor {}", options.sensor), knows_beams);
  const int columns = plan.recording_sensor.columns;
  if (!knows_columns || columns == sensor.columns) return;
  throw Error(
      fmt::format("{}: the sensor sends {} columns a turn, {} takes {}; set it to another "
                  "mode",
                  options.sensor, sensor.columns, options.upsample, columns));
}

void print_sensor(const live::LiveSensor& sensor, const RunPlan& plan) {
  for (const std::string& warning : sensor.warnings()) to_stderr("hqslam: {}\n", warning);
  to_stdout("{} from {}: {}, {} rows x {} columns, {:.4g} turns a second\n", sensor.format(),
            text(sensor.sender()), sensor.sensor().name, sensor.sensor().rows(),
            plan.recording_sensor.columns, 1.0 / sensor.sensor().scan_period_s);
}

void print_summary(const SlamRun& run, const live::LiveCounts& counts,
                   const LiveCommandOptions& options) {
  std::vector<double> latencies_ms;
  for (const ScanRecord& scan : run.scans) latencies_ms.push_back(1e3 * scan.latency_s.value());
  const Distribution latency = distribution_of(std::move(latencies_ms));
  to_stdout("{}", run_summary(run));
  to_stdout(
      "from the packet that completes a scan to its pose: median {:.1f}, 95 % {:.1f}, "
      "longest {:.1f} ms\n",
      latency.median, latency.p95, latency.max);
  to_stdout("{} packets, {} lost; {} of {} scans dropped\n", counts.packets.used,
            counts.packets.lost, counts.dropped_scans, counts.scans);
  to_stdout(
      "results: {}/trajectory.tum, trajectory.kitti, covariances.csv, map.pcd, timings.json, "
      "report.html\n",
      options.out);
  if (run.left_out.scans > 0) to_stderr("hqslam: {}\n", run.left_out.text());
}

/// What to tell the shell, with the line on stderr that explains it.
int exit_status_of(const SlamRun& run, const live::LiveCounts& counts) {
  if (run.end == RunEnd::kUnreadableScan) {
    to_stderr("hqslam: {}; the results up to there are valid\n", run.end_message);
    return kWrongInput;
  }
  if (!counts.recording_failure.empty()) {
    to_stderr("hqslam: {}; the recording ends there, the results are whole\n",
              counts.recording_failure);
    return kWrongInput;
  }
  return kOk;
}

}  // namespace

void declare_live(CLI::App& app, LiveCommandOptions& options) {
  CLI::App* command =
      app.add_subcommand("live", "From a sensor that sends now to a trajectory and a map");
  command
      ->add_option(
          "--sensor", options.sensor,
          fmt::format("{}, or a .json file: an Ouster's metadata, or the beam angles of one "
                      "Velodyne; or the db.xml of an HDL-64E. An Ouster that is only named is "
                      "asked for its metadata over HTTP",
                      fmt::join(sensor_preset_names(), ", ")))
      ->required();
  command
      ->add_option("--port", options.port,
                   "UDP port to which it sends (default: what an Ouster's metadata say or 7502, "
                   "2368 for a Velodyne)")
      ->check(CLI::Range(1, 65535));
  declare_return(*command, options.kept_return);
  declare_lifting(*command, options);
  command->add_option("--out", options.out, "Folder for the results; made if it is not there")
      ->required();
  command->add_option("--record", options.record,
                      "Also keep the packets in this .pcap file, an Ouster's metadata beside it");
  command
      ->add_option("--view", options.view,
                   fmt::format("Show path and map on a page as they grow; port of the page ({} if "
                               "none is given, 0: any free one)",
                               kViewPort))
      ->expected(0, 1)
      ->default_str(std::to_string(kViewPort))
      ->check(CLI::Range(0, 65535));
  command
      ->add_option("--view-address", options.view_address,
                   "Address at which the page is served; by default to this computer alone")
      ->capture_default_str();
  declare_threads(*command, options.threads);
  declare_slam_settings(*command, options.slam);
  command->footer(
      "The sensor must send to this computer already. A line each second says where it is, how\n"
      "many scans a second were located, the longest time from the packet that completes a scan\n"
      "to its pose, and what was lost: packets that never came, and whole scans that had to make\n"
      "room for later ones because the computer is too slow. Ctrl-C (or SIGTERM) ends it: exit\n"
      "status 0, and in --out the results as hqslam run writes them.");
}

int live_command(const LiveCommandOptions& options) {
  const InterruptGuard interrupt;
  use_threads(options.threads);
  const slam::SlamOptions slam = slam_options(options.slam);
  RunOutput output(options.out);
  require_possible(options);
  live::LiveSensor sensor(sensor_options(options));
  LiveView view(fmt::format("hqslam live, {}", options.sensor));
  std::optional<ViewServer> server;
  if (options.view) {
    server.emplace(options.view_address, *options.view,
                   [&view](const std::string& target) { return view.answer(target); });
    to_stdout("page: {}\n", server->url());
  }
  if (!wait_for_sensor(sensor, interrupt)) return kOk;
  RunPlan plan = plan_of(options, sensor.sensor(), fmt::format("UDP port {}", sensor.port()));
  print_sensor(sensor, plan);
  SlamRunSpec spec = plan.spec();
  spec.slam = slam;
  sensor.start(plan.recording_sensor.columns);
  const SlamRun run = run_live(sensor, spec, output, interrupt, server ? &view : nullptr);
  const live::LiveCounts counts = sensor.counts();
  if (run.scans.empty()) {
    if (run.end == RunEnd::kUnreadableScan) throw Error(run.end_message);
    to_stderr("hqslam: interrupted before the first scan; nothing was written\n");
    return kOk;
  }
  output.write_results(run, std::nullopt);
  print_summary(run, counts, options);
  return exit_status_of(run, counts);
}

}  // namespace hqslam::tools

#include "live/maps_on_demand.h"

#include <fmt/format.h>
#include <omp.h>
#include <sys/resource.h>
#include <unistd.h>

#include <filesystem>
#include <utility>

#include "hqslam/core/whole_file.h"
#include "live/live_run.h"

namespace hqslam::tools {

InputChoice recording_of(const LiveOptions& options) {
  InputChoice recording{options.record};
  recording.kept_return = options.kept_return;
  const auto metadata = std::filesystem::path(options.record).replace_extension(".json");
  if (!std::filesystem::exists(metadata)) recording.sensor = options.sensor;
  return recording;
}

void MapsOnDemand::begin_if_asked(SlamSession& session) {
  if (is_busy_ || !is_asked_.exchange(false)) return;
  if (thread_.joinable()) thread_.join();
  SlamRun run;
  if (const std::string failure =
          failure_of_writing([&] { run = session.so_far(options_.save_map); });
      !failure.empty()) {
    return set_state("no maps saved: " + failure);
  }
  is_busy_ = true;
  set_state(fmt::format("making the maps of {} scans", run.scans.size()));
  thread_ = std::thread([this, run = std::move(run)] {
    setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), 10);
    omp_set_num_threads(1);  // the other cores are for the poses
    const std::string failure = failure_of_writing([&] { make(run); });
    set_state(!failure.empty() ? "no maps saved: " + failure
              : interrupt_.stop_requested()
                  ? ""
                  : fmt::format("maps of {} scans saved", run.scans.size()));
    is_busy_ = false;
  });
}

void MapsOnDemand::make(const SlamRun& run) const {
  const std::filesystem::path folder = options_.out;
  if (run.saved_map) {
    replace_file((folder / "saved_map.npz").string(),
                 [&](const std::string& part) { slam::write_saved_map(part, *run.saved_map); });
  }
  const InputChoice recording = recording_of(options_);
  if (options_.occupancy_grid && !interrupt_.stop_requested()) {
    const OccupancyGridRun grid =
        build_occupancy_grid(recording, options_, poses_of(run), options_.grid, interrupt_);
    if (!interrupt_.stop_requested()) write_occupancy_grid(grid.map, folder);
  }
  if (options_.dense_map && !interrupt_.stop_requested()) {
    const DenseMapRun map =
        build_dense_map(recording, options_, poses_of(run), options_.map, interrupt_);
    if (!interrupt_.stop_requested()) write_dense_map(map, folder);
  }
}

void MapsOnDemand::finish() {
  if (thread_.joinable()) thread_.join();
}

std::optional<std::string> MapsOnDemand::state() const {
  if (!can_be_made()) return std::nullopt;
  const std::lock_guard lock(mutex_);
  return state_;
}

void MapsOnDemand::set_state(const std::string& state) {
  const std::lock_guard lock(mutex_);
  state_ = state;
  if (!state.empty()) to_stdout("{}\n", state);
}

}  // namespace hqslam::tools

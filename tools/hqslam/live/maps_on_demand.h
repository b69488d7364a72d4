#pragma once

#include <atomic>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "live/live_command.h"
#include "run/slam_session.h"
#include "terminal/terminal.h"

namespace hqslam::tools {

/// The capture that --record writes, as hqslam run would open it.
InputChoice recording_of(const LiveOptions& options);

/// The chosen maps (--save-map, --occupancy-grid, --dense-map) of a drive that goes on, each time
/// that they are asked for: of the scans so far, in a thread that gives way to all others.
class MapsOnDemand {
 public:
  /// The references are kept.
  MapsOnDemand(const LiveOptions& options, const InterruptGuard& interrupt)
      : options_(options), interrupt_(interrupt) {}
  ~MapsOnDemand() { finish(); }
  MapsOnDemand(const MapsOnDemand&) = delete;
  MapsOnDemand& operator=(const MapsOnDemand&) = delete;

  /// Whether any map was chosen.
  bool can_be_made() const {
    return options_.save_map || options_.occupancy_grid || options_.dense_map;
  }
  /// Called by any thread. While maps are made, the next ones wait for these.
  void ask() { is_asked_ = true; }
  /// Between two scans: begins if the maps were asked for. The results' folder is there already.
  void begin_if_asked(SlamSession& session);
  /// Waits for what was begun; an interrupt ends it at once.
  void finish();
  /// "making the maps of 120 scans", "maps of 120 scans saved", why they were not; nothing: no map
  /// was chosen.
  std::optional<std::string> state() const;

 private:
  void make(const SlamRun& run) const;
  void set_state(const std::string& state);

  const LiveOptions& options_;
  const InterruptGuard& interrupt_;
  std::atomic<bool> is_asked_ = false;
  std::atomic<bool> is_busy_ = false;
  std::thread thread_;
  mutable std::mutex mutex_;  ///< of state_
  std::string state_;
};

}  // namespace hqslam::tools

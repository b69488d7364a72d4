#pragma once

#include <functional>
#include <string>

#include "hqslam/live/live.h"
#include "live/live_view.h"
#include "run/run_output.h"
#include "run/slam_session.h"
#include "terminal/terminal.h"

namespace hqslam::tools {

/// "12 s  120 scans  x 3.21 y -0.40 z 0.02 m  10.0 scans/s  latency 23 ms  0 packets lost  0 scans
/// dropped"
std::string status_line(const LiveStatus& status);

/// Waits until the sensor's packets are recognized, with a line each second. Returns false if it
/// was interrupted before. Throws Error.
bool wait_for_sensor(live::LiveSensor& sensor, const InterruptGuard& interrupt);

/// Calls write(); returns what went wrong, in one line, "" where nothing did.
std::string failure_of_writing(const std::function<void()>& write);

/// The scans of a sensor that was started through the pipeline, as they come, until it is
/// interrupted or the port fails. Results that cannot be written now are written later; the status
/// line shows it. Prints a status line a second. view: shows the run; nullptr: there is none.
/// save_map: the run gets a map for later drives.
SlamRun run_live(live::LiveSensor& sensor, SlamSession session, RunOutput& output,
                 const InterruptGuard& interrupt, LiveView* view, bool save_map);

}  // namespace hqslam::tools

#include <hqslam/pipeline/pipeline.h>
#include <hqslam/recordings/recording.h>

#include <condition_variable>
#include <iostream>
#include <queue>
#include <thread>

// A driver's callback hands over the points of each turn; a thread of its own locates them.
int main(int argc, char** argv) {
  if (argc != 2) return 2;
  auto recording = hqslam::recordings::Recording::open(argv[1]);  // plays the driver
  hqslam::pipeline::Pipeline pipeline(recording.sensor());
  std::mutex mutex;
  std::condition_variable changed;
  std::queue<hqslam::Scan> turns;
  const auto callback = [&](const hqslam::Scan& points) {  // a sensor's would bound the queue
    const std::lock_guard lock(mutex);
    turns.push(points);
    changed.notify_one();
  };
  std::jthread slam([&] {
    while (true) {
      std::unique_lock lock(mutex);
      changed.wait(lock, [&] { return !turns.empty(); });
      const hqslam::Scan points = turns.front();
      turns.pop();
      lock.unlock();
      if (points.points_m.empty()) return;  // the end
      std::cout << pipeline.process(points).report.T_map_sensor.translation().transpose() << '\n';
    }
  });
  while (const auto scan = recording.next()) {
    auto points = hqslam::returns_of(scan->cloud);  // x y z, row, time after the stamp
    points.stamp_s = scan->stamp_s;
    callback(points);
  }
  callback(hqslam::Scan());
}

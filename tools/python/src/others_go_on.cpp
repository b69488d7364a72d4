#include "others_go_on.h"

#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

namespace hqslam::python {

namespace {

struct End {
  std::mutex mutex;
  std::condition_variable changed;
  std::optional<std::thread::id> ending;  ///< the thread that ends the process
  int returning = 0;                      ///< threads that wait for Python
};

/// Never destroyed: threads sleep in it at the end.
End& end() {
  static End& end = *new End;
  return end;
}

}  // namespace

OthersGoOn::~OthersGoOn() {
  {
    std::unique_lock lock(end().mutex);
    end().changed.wait(lock,
                       [] { return !end().ending || *end().ending == std::this_thread::get_id(); });
    ++end().returning;
  }
  PyEval_RestoreThread(thread_);
  {
    const std::scoped_lock lock(end().mutex);
    --end().returning;
  }
  end().changed.notify_all();
}

void let_others_sleep() {
  PyThreadState* thread = PyEval_SaveThread();  // those that wait for Python get it
  {
    std::unique_lock lock(end().mutex);
    end().ending = std::this_thread::get_id();
    end().changed.wait(lock, [] { return end().returning == 0; });
  }
  PyEval_RestoreThread(thread);
}

}  // namespace hqslam::python

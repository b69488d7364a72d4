#include "table/table_progress.h"

namespace hqslam::tools {

void TableProgress::step(const std::string& title) {
  const std::lock_guard lock(mutex_);
  progress_.relabel(title);
}

void TableProgress::advance() {
  const std::lock_guard lock(mutex_);
  progress_.update(++done_);
}

void TableProgress::finish() {
  const std::lock_guard lock(mutex_);
  progress_.finish();
}

}  // namespace hqslam::tools

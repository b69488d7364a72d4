#include "hqslam/core/left_out.h"

#include <fmt/format.h>

#include "hqslam/core/error.h"

namespace hqslam {

void LeftOut::add(const std::string& what) {
  if (scans++ == 0) first = what;
  if (each.size() < kMostNamed) each.push_back(what);
}

std::string LeftOut::text() const {
  return fmt::format("{} scan{} left out{}: {}", scans, scans == 1 ? " was" : "s were",
                     scans == 1 ? "" : ", the first of them", first);
}

std::optional<RecordedScan> next_usable(ScanSource& source, LeftOut& left_out) {
  while (true) {
    try {
      return source.next();
    } catch (const ScanError& error) {
      left_out.add(error.what());
    }
  }
}

}  // namespace hqslam

#pragma once

#include <string>
#include <utility>
#include <vector>

#include "hqslam/core/range_image.h"

namespace hqslam::tools {

/// The demo's table as text: the same cells are printed and shown.
struct DemoTable {
  std::vector<std::string> columns;
  struct Row {
    std::string name;
    std::string report;  ///< path of its page, relative to the demo's
    std::vector<std::string> cells;
  };
  std::vector<Row> rows;
  std::vector<std::string> notes;
};

/// A page that needs no other file but the runs' reports, which it names: the table and one scan in
/// every form that SLAM got to see. max_range_m: of the colours.
std::string demo_html(const DemoTable& table,
                      const std::vector<std::pair<std::string, RangeImage>>& images,
                      double max_range_m);

}  // namespace hqslam::tools

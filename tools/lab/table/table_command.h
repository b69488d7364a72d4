#pragma once

#include "table/table_plan.h"

namespace CLI {
class App;
}

namespace hqslam::tools {

void declare(CLI::App& app, TableOptions& options);
/// Returns an ExitStatus. Throws Error.
int run(const TableOptions& options);

}  // namespace hqslam::tools

#pragma once

#include "table/table_plan.h"

namespace CLI {
class App;
}

namespace hqslam::tools {

void declare_table(CLI::App& app, TableOptions& options);
/// Returns an ExitStatus. Throws Error.
int table_command(const TableOptions& options);

}  // namespace hqslam::tools

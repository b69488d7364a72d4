#pragma once

#include <CLI/App.hpp>

#include "table_plan.h"

namespace hqslam::tools {

void declare_table(CLI::App& app, TableOptions& options);
/// Returns an ExitStatus. Throws Error.
int table_command(const TableOptions& options);

}  // namespace hqslam::tools

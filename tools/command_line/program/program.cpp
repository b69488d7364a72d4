#include "program/program.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <malloc.h>
#include <omp.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include "hqslam/core/error.h"
#include "hqslam/core/nearest_names.h"
#include "program/help_formatter.h"
#include "program/invocation.h"
#include "terminal/terminal.h"

namespace hqslam::tools {
namespace {

/// Names that the arguments which nothing expects may stand for.
std::string nearest_to(const std::vector<std::string>& unexpected, const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* subcommand : app.get_subcommands({}))
    names.push_back(subcommand->get_name());
  for (const CLI::Option* option : app.get_options({})) names.push_back(option->get_name());
  for (const std::string& text : unexpected) {
    if (!text.starts_with('-') && app.get_parent() != nullptr) continue;  // a value, not a name
    const std::string near = did_you_mean(text.substr(0, text.find('=')), names);
    if (!near.empty()) return near;
  }
  return "";
}

int report_parse_error(const CLI::App& app, const CLI::ParseError& error) {
  if (error.get_exit_code() == 0) {
    return app.exit(error);  // --help and --version
  }
  const std::string program = app.get_name();
  const auto subcommands = app.get_subcommands();
  const std::string name = subcommands.empty() ? "" : subcommands.front()->get_name();
  if (name.empty() && !app.remaining().empty()) {
    to_stderr("{0}: '{1}' is no subcommand; {0} --help lists them{2}\n", program,
              app.remaining().front(), nearest_to(app.remaining(), app));
    return kWrongInput;
  }
  const CLI::App& asked = subcommands.empty() ? app : *subcommands.front();
  const std::vector<std::string> unexpected = asked.remaining();
  // Its text has them in reverse.
  const bool is_extra = dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr;
  to_stderr(
      "{0}: {1}; {0} {2}{3}--help lists what is expected{4}\n", program,
      is_extra ? fmt::format("found unexpected '{}'", fmt::join(unexpected, " ")) : error.what(),
      name, name.empty() ? "" : " ", nearest_to(unexpected, asked));
  return kWrongInput;
}

/// The next scan needs the memory that one has freed: returned to the system at once, it would come
/// back by page faults, a twentieth of SLAM's time with 64 rows.
void keep_freed_memory() {
#ifdef __GLIBC__
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, 128 << 20);
#endif
}

/// libgomp's waiting threads spin for milliseconds by default and keep a core from other processes:
/// beside two busy ones everything took four times as long. With a short spin they soon sleep.
/// libgomp reads the setting from the environment before main() begins, so the program starts
/// itself once more, under its own name (top and killall show and take that of the file that was
/// started, for /proc/self/exe "exe"); a user's own setting stands.
void wait_briefly(char** argv) {
  constexpr const char* kTurns = "2000";
  if (std::getenv("OMP_WAIT_POLICY") != nullptr || std::getenv("GOMP_SPINCOUNT") != nullptr) return;
  std::error_code error;
  const std::string program = std::filesystem::read_symlink("/proc/self/exe", error);
  if (setenv("GOMP_SPINCOUNT", kTurns, 0) == 0) execv(program.c_str(), argv);
  // Here only if it could not start itself: threads wait as they do by default.
}

/// OMP_NUM_THREADS may hold any number; the stacks of too many threads do not fit.
void limit_threads() {
  constexpr int kMostThreads = 256;
  if (omp_get_max_threads() > kMostThreads) omp_set_num_threads(kMostThreads);
}

/// Parses, runs the chosen subcommand and returns its ExitStatus.
int exit_status_of(CLI::App& app, const Chosen& chosen, int argc, const char* const* argv) {
  const std::string program = app.get_name();
  keep_invocation(program, argc, argv);
  try {
    app.parse(argc, argv);
    return chosen();
  } catch (const CLI::ParseError& error) {
    return report_parse_error(app, error);
  } catch (const Error& error) {
    to_stderr("{}: {}\n", program, error.what());
    return kWrongInput;
  } catch (const std::filesystem::filesystem_error& error) {
    to_stderr("{}: {}: {}; check the path\n", program, error.path1().string(),
              error.code().message());
    return kWrongInput;
  } catch (const std::exception& error) {
    to_stderr("{}: failed: {}\n", program, error.what());
    return kFailure;
  }
}

}  // namespace

void declare_program(CLI::App& app, const Program& program, Chosen& chosen) {
  app.description(program.description);
  app.set_version_flag("--version", program.name + " " HQSLAM_VERSION);
  app.set_help_flag("-h,--help", "Print this help and exit");
  app.formatter(std::make_shared<HelpFormatter>());
  app.require_subcommand(1);
  app.footer(
      "Exit status: 0 done, 2 wrong input (one line on stderr: what is wrong, how to mend it),\n"
      "130 interrupted, 1 anything else.");
  for (const AddSubcommand add : program.subcommands) add(app, chosen);
}

void when_chosen(CLI::App& app, std::function<void()> call) {
  app.get_subcommands({}).back()->callback(std::move(call));
}

int run_program(const Program& program, int argc, char** argv) {
  wait_briefly(argv);
  keep_freed_memory();
  prepare_standard_streams();
  limit_threads();
  CLI::App app("", program.name);
  Chosen chosen;
  declare_program(app, program, chosen);
  const int status = exit_status_of(app, chosen, argc, argv);
  return all_printed() || status != kOk ? status : kFailure;
}

}  // namespace hqslam::tools

#include "bench/bench_text.h"

#include <fmt/format.h>

#include <functional>
#include <optional>
#include <vector>

#include "pages/printed_table.h"

namespace hqslam::tools {
namespace {

using Json = nlohmann::ordered_json;

double number(const Json& measured, const char* pointer) {
  return measured.at(Json::json_pointer(pointer)).get<double>();
}

/// A number of each row, by its JSON pointer; nothing where it, or what has it, is null.
Figure<Json> column(const char* title, int decimals, const char* pointer, double scale = 1.0) {
  const auto of = [path = Json::json_pointer(pointer)](const Json& row) {
    return row.contains(path) && row.at(path).is_number()
               ? std::optional(row.at(path).get<double>())
               : std::nullopt;
  };
  return {title, nullptr, decimals, scale, of};
}

std::string table_text(const Json& rows, const char* names,
                       const std::vector<Figure<Json>>& figures,
                       const std::function<std::string(const Json&)>& name) {
  return printed_table(table_of(rows.get_ref<const Json::array_t&>(), names, figures, name));
}

std::string threads_text(const Json& row) {
  const int threads = row["threads"];
  return fmt::format("{} thread{}", threads, threads == 1 ? "" : "s");
}

/// "64", or "16, du-mix, memory".
std::string rows_text(const Json& timing) {
  const std::string by = timing["upsampled_by"];
  return fmt::format("{}{}{}", timing["rows"].get<int>(), by.empty() ? "" : ", ", by);
}

std::string slam_text(const Json& slam) {
  const std::vector<Figure<Json>> stages = {
      column("threads", 0, "/threads"),
      column("upsampling", 2, "/upsampling_ms/median"),
      column("segmentation", 2, "/stages_ms/segmentation/median"),
      column("features", 2, "/stages_ms/features/median"),
      column("odometry", 2, "/stages_ms/odometry/median"),
      column("mapping", 2, "/stages_ms/mapping/median")};
  const std::vector<Figure<Json>> totals = {column("threads", 0, "/threads"),
                                            column("scans", 0, "/scans"),
                                            column("median", 2, "/stages_ms/total/median"),
                                            column("95 %", 2, "/stages_ms/total/p95"),
                                            {"scans/s", nullptr, 1, 1.0, [](const Json& row) {
                                               return 1e3 / number(row, "/stages_ms/total/mean");
                                             }}};
  return "SLAM's stages, median ms per scan\n\n" + table_text(slam, "Rows", stages, rows_text) +
         "\nUpsampling and SLAM together, ms per scan\n\n" +
         table_text(slam, "Rows", totals, rows_text) + "\n" +
         printed_definitions(
             {{"Rows", "measured rows, and the method that upsamples them"},
              {"upsampling", "from measured points to points of all rows, with its memory"},
              {"scans/s", "from the mean time"}}) +
         "\n";
}

std::string instruction_set_text(const Json& row) { return row["instruction_set"]; }

std::string runs_text(const Json& runs) {
  return table_text(runs, "instructions",
                    {column("threads", 0, "/threads"), column("frames", 0, "/frames"),
                     column("frames/s", 1, "/frames_per_second"),
                     column("ms/frame", 2, "/frame_ms/median"), column("95 %", 2, "/frame_ms/p95"),
                     column("GFLOP/s", 1, "/gflops"), column("% of peak", 1, "/peak_share", 100.0)},
                    instruction_set_text);
}

/// Median time of a frame in the run with the steps' instruction set and these threads.
double whole_ms(const Json& network, const Json& threads) {
  for (const Json& run : network["runs"]) {
    if (run["instruction_set"] == network["steps_instruction_set"] && run["threads"] == threads) {
      return number(run, "/frame_ms/median");
    }
  }
  return 0.0;
}

/// A row for each step of the network, two columns for each number of threads.
std::string network_steps_text(const Json& network) {
  TextTable table{.columns = {"step", "GMAC"}};
  std::vector<std::string> whole = {"whole frame", ""};
  for (const Json& of_threads : network["steps"]) {
    table.columns.insert(table.columns.end(), {threads_text(of_threads), "GFLOP/s"});
    whole.insert(whole.end(),
                 {fmt::format("{:.3f}", whole_ms(network, of_threads["threads"])), ""});
    const Json& steps = of_threads["steps"];
    table.rows.resize(steps.size());
    for (std::size_t i = 0; i < steps.size(); ++i) {
      std::vector<std::string>& cells = table.rows[i];
      const double gmac = steps[i]["gmac"];
      const double ms = steps[i]["ms"];
      const bool convolves = gmac > 0.0 && ms > 0.0;
      if (cells.empty()) {
        cells = {steps[i]["name"], gmac > 0.0 ? fmt::format("{:.3f}", gmac) : kNoFigure};
      }
      cells.push_back(fmt::format("{:.3f}", ms));
      cells.push_back(convolves ? fmt::format("{:.0f}", 2e3 * gmac / ms) : kNoFigure);
    }
  }
  table.rows.push_back(whole);
  return printed_table(table);
}

std::string network_text(const Json& network) {
  std::string text =
      fmt::format("\n{}: whole network, filter included; {} parameters, {:.3f} GMAC a frame\n",
                  network["network"].get<std::string>(), network["parameters"].get<std::int64_t>(),
                  network["gmac"].get<double>());
  text += runs_text(network["runs"]);
  text += fmt::format("\nsteps of the network, each measured alone, {}, median ms per frame\n",
                      network["steps_instruction_set"].get<std::string>());
  text += network_steps_text(network);
  if (!network.contains("reference")) return text;
  const Json& reference = network["reference"];
  const double fast_ms = reference["fast_ms"];
  const double reference_ms = reference["reference_ms"];
  return text + fmt::format(
                    "  {} as its reference formula: {:.1f} ms, as used: {:.3f} ms ({:.0f} times "
                    "as fast, one thread)\n",
                    reference["layer"].get<std::string>(), reference_ms, fast_ms,
                    reference_ms / fast_ms);
}

}  // namespace

std::string bench_text(const Json& measured) {
  std::string text =
      fmt::format("{}, sensor {}, {} cores\n\n", measured["input"].get<std::string>(),
                  measured["sensor"].get<std::string>(), measured["cores"].get<int>());
  text += slam_text(measured["slam"]);
  if (measured["networks"].empty()) return text;
  text += "Measured peak of multiply-adds in registers, GFLOP/s\n";
  text += table_text(measured["peaks"], "instructions",
                     {column("threads", 0, "/threads"), column("GFLOP/s", 1, "/gflops")},
                     instruction_set_text);
  for (const Json& network : measured["networks"]) text += network_text(network);
  return text;
}

}  // namespace hqslam::tools

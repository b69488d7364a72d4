#include "product.h"

#include <doctest/doctest.h>

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "tools/parts_of_text.h"

namespace hqslam::tools {
namespace {

/// What the arguments after "hqslam" make of the options of a command. Throws CLI::ParseError.
template <typename Options = RunOptions>
Options parsed(std::vector<std::string> arguments) {
  CLI::App app("", "hqslam");
  CommandLine options;
  declare_program(app, options);
  std::vector<std::string> reversed(arguments.rbegin(), arguments.rend());
  app.parse(reversed);
  return std::get<Options>(options.commands);
}

}  // namespace

TEST_CASE("the options of run arrive where they belong") {
  const auto run = parsed<RunOptions>({"run", "/", "--sensor", "os1-64", "--rows", "16", "--out",
                                       "x", "--row-order", "lowest-first", "--motion-corrected",
                                       "--threads", "2", "--upsample", "linear"});
  CHECK(run.input == "/");
  CHECK(run.sensor == "os1-64");
  CHECK(run.rows == 16);
  CHECK(run.out == "x");
  CHECK(run.row_order == "lowest-first");
  CHECK(run.motion_corrected);
  CHECK(run.threads == 2);
  CHECK(run.upsample == "linear");
}

TEST_CASE("the options of upsample arrive where they belong") {
  const auto upsample = parsed<UpsampleOptions>({"upsample", "/", "--method", "inverse", "--sensor",
                                                 "os1-64", "--out", "x", "--bin", "--png",
                                                 "--threads", "2", "--row-order", "lowest-first"});
  CHECK(upsample.input == "/");
  CHECK(upsample.upsample == "inverse");
  CHECK(upsample.sensor == "os1-64");
  CHECK(upsample.out == "x");
  CHECK(upsample.formats.kitti_bin);
  CHECK_FALSE(upsample.formats.pcd);
  CHECK(upsample.formats.png);
  CHECK(upsample.threads == 2);
  CHECK(upsample.row_order == "lowest-first");
}

TEST_CASE("the options of live arrive where they belong, --view with a port and without") {
  const auto live = parsed<LiveOptions>({"live",     "--sensor",   "os1-16",
                                         "--port",   "7000",       "--rows",
                                         "16",       "--out",      "x",
                                         "--return", "last",       "--threads",
                                         "2",        "--upsample", "linear",
                                         "--record", "a.pcap",     "--no-loop-closing",
                                         "--view",   "8000",       "--view-address",
                                         "0.0.0.0"});
  CHECK(live.sensor == "os1-16");
  CHECK(live.port == 7000);
  CHECK(live.rows == 16);
  CHECK(live.kept_return == "last");
  CHECK(live.upsample == "linear");
  CHECK(live.record == "a.pcap");
  CHECK(live.threads == 2);
  CHECK_FALSE(live.slam.loop_closing);
  CHECK(live.view == 8000);
  CHECK(live.view_address == "0.0.0.0");
  const auto plain = parsed<LiveOptions>({"live", "--sensor", "vlp-16", "--out", "x"});
  CHECK_FALSE(plain.view);
  CHECK(plain.view_address == "127.0.0.1");
  CHECK(parsed<LiveOptions>({"live", "--sensor", "vlp-16", "--out", "x", "--view"}).view == 8642);
}

TEST_CASE("every command that opens recordings reads them as run does") {
  const std::vector<std::string> reading = {"--stream",    "7502",        "--return", "last",
                                            "--capture",   "rolling",     "--stamps", "names",
                                            "--row-order", "lowest-first"};
  const auto with = [&]<typename Options>(Options, std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), reading.begin(), reading.end());
    return parsed<Options>(arguments);
  };
  for (const InputChoice& choice : std::vector<InputChoice>{
           with(RunOptions{}, {"run", "/", "--out", "x"}),
           with(MapOptions{}, {"map", "/", "--poses", "/proc/version", "--out", "x"}),
           with(InspectOptions{}, {"inspect", "/", "--weights", "a", "--out", "x"}),
           with(UpsampleOptions{}, {"upsample", "/", "--method", "linear", "--out", "x"}),
           with(CompareOptions{}, {"compare", "/"}),
           with(TableOptions{}, {"table", "--out", "x"}).reading,
           with(BenchOptions{}, {"bench", "--input", "/"}).recording}) {
    CHECK(choice.stream == "7502");
    CHECK(choice.kept_return == "last");
    CHECK(choice.capture == "rolling");
    CHECK(choice.stamps == "names");
    CHECK(choice.row_order == "lowest-first");
  }
}

TEST_CASE("the options of table arrive where they belong, lists split at commas") {
  const auto table = parsed<TableOptions>(
      {"table", "--drives", "town,/", "--methods", "rows-16,du-or", "--weights", "a,b", "--sensor",
       "hdl-64e", "--reference", "/proc/version", "--scans", "7", "--out", "x", "--threads", "2"});
  CHECK(table.drives == std::vector<std::string>{"town", "/"});
  CHECK(table.methods == std::vector<std::string>{"rows-16", "du-or"});
  CHECK(table.weights == std::vector<std::string>{"a", "b"});
  CHECK(table.reading.sensor == "hdl-64e");
  CHECK(table.reference == "/proc/version");
  CHECK(table.scans == 7);
  CHECK(table.out == "x");
  CHECK(table.threads == 2);
  CHECK(parsed<TableOptions>({"table", "--out", "x"}).drives ==
        std::vector<std::string>{"town", "hills"});
}

TEST_CASE("the options of simulate, demo, view and bench arrive where they belong") {
  const auto simulate =
      parsed<SimulateOptions>({"simulate", "--drive", "town", "--sensor", "vlp-16", "--out", "x",
                               "--scans", "7", "--seed", "9", "--bin"});
  CHECK(simulate.drive == "town");
  CHECK(simulate.scans == 7);
  CHECK(simulate.seed == 9);
  CHECK(simulate.bin);
  CHECK_FALSE(simulate.pcd);
  CHECK(parsed<DemoOptions>({"demo", "--out", "y"}).out == "y");
  const auto view = parsed<ViewOptions>(
      {"view", "/", "/proc", "--sensor", "vlp-16", "--scan", "3", "--out", "x"});
  CHECK(view.files == std::vector<std::string>{"/", "/proc"});
  CHECK(view.sensor == "vlp-16");
  CHECK(view.scan == 3);
  CHECK(view.out == "x");
  CHECK(parsed<BenchOptions>({"bench", "--json", "--scans", "20"}).json);
  CHECK(parsed<BenchOptions>({"bench", "--drive", "hills"}).drive == "hills");
  CHECK(parsed<BenchOptions>({"bench", "--cpu"}).cpu);
  CHECK(parsed<BenchOptions>({"bench", "--weights", "/dev/null", "--weights", "/dev/null"})
            .weights.size() == 2);
}

TEST_CASE("what makes no sense is refused") {
  const std::vector<std::vector<std::string>> wrong = {
      {"run"},
      {"run", "/"},
      {"run", "/", "--out", "x", "--rows", "0"},
      {"run", "/", "--out", "x", "--rows", "many"},
      {"run", "/", "--out", "x", "--row-order", "sideways"},
      {"run", "/", "--out", "x", "--threads", "0"},
      {"run", "/", "--out", "x", "--reference", "/no/such/file"},
      {"run", "/", "--out", "x", "--upsample", "cubic"},
      {"upsample", "/", "--method", "linear"},
      {"simulate", "--drive", "town", "--sensor", "os1-64", "--out", "x", "--scans", "-3"},
      {"evaluate", "/no/such/file", "/no/such/file"},
      {"live", "--sensor", "vlp-16"},
      {"live", "--sensor", "vlp-16", "--out", "x", "--port", "70000"},
      {"live", "--sensor", "vlp-16", "--out", "x", "--view-address", "0.0.0.0"},
      {"bench", "--sensor", "os1-64"},
      {"view", "/"},
      {"view", "--out", "x"},
      {"view", "/", "--out", "x", "--scan", "-1"},
      {"compare", "/", "--curve", "c.html", "--layers"},
      {"compare", "/", "--curve", "c.html", "--filters"},
  };
  for (const std::vector<std::string>& arguments : wrong) {
    CAPTURE(arguments.size());
    CHECK_THROWS_AS(parsed(arguments), CLI::ParseError);
  }
}

TEST_CASE("a seed is a whole number from 0 to 2^64 - 1") {
  const auto seed = [](const std::string& text) {
    return parsed<SimulateOptions>(
               {"simulate", "--drive", "town", "--sensor", "vlp-16", "--out", "x", "--seed", text})
        .seed;
  };
  CHECK(seed("0") == 0);
  CHECK(seed("18446744073709551615") == 18446744073709551615ULL);
  for (const char* wrong :
       {"-1", "99999999999999999999", "18446744073709551616", "1.5", "0x10", "one", ""}) {
    CAPTURE(wrong);
    CHECK_THROWS_AS(seed(wrong), CLI::ParseError);
  }
}

TEST_CASE(
    "the program's help names every subcommand, evaluate's its errors, calibrate's recordings") {
  CLI::App app("", "hqslam");
  CommandLine options;
  declare_program(app, options);
  CHECK(missing(app.help(), {"run", "live", "demo", "simulate", "evaluate", "bench", "upsample"}) ==
        "");
  const std::string help = app.get_subcommand("evaluate")->help();
  CHECK(missing(help, {"APE", "RPE", "MAE", "Chamfer", "IoU", "F1", "outlier", "TULIP", "evo"}) ==
        "");
  CHECK(missing(app.get_subcommand("calibrate")->help(),
                {".pcap", ".mcap", ".bin", ".pcd", ".ply", ".las", ".csv", ".txt"}) == "");
}

}  // namespace hqslam::tools

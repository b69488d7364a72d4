#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "product.h"
#include "tools/command_line/parsed_options.h"
#include "tools/parts_of_text.h"

namespace hqslam::tools {
namespace {

template <typename Options = RunOptions>
Options parsed(const std::vector<std::string>& arguments) {
  return parsed_options<ProductCommands, Options>(product_text(), arguments);
}

}  // namespace

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
           with(UpsampleOptions{}, {"upsample", "/", "--method", "linear", "--out", "x"})}) {
    CHECK(choice.stream == "7502");
    CHECK(choice.kept_return == "last");
    CHECK(choice.capture == "rolling");
    CHECK(choice.stamps == "names");
    CHECK(choice.row_order == "lowest-first");
  }
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
      {"evaluate", "/no/such/file", "/no/such/file"},
      {"live", "--sensor", "vlp-16"},
      {"live", "--sensor", "vlp-16", "--out", "x", "--port", "70000"},
      {"live", "--sensor", "vlp-16", "--out", "x", "--view-address", "0.0.0.0"},
      {"view", "/"},
      {"view", "--out", "x"},
      {"view", "/", "--out", "x", "--scan", "-1"},
  };
  for (const std::vector<std::string>& arguments : wrong) {
    CAPTURE(arguments.size());
    CHECK_THROWS_AS(parsed(arguments), CLI::ParseError);
  }
}

TEST_CASE("the help names every subcommand, evaluate's its errors, calibrate's recordings") {
  const auto help = [](const char* command) {
    return help_of<ProductCommands>(product_text(), command);
  };
  CHECK(missing(help(""), {"run", "live", "evaluate", "upsample", "info", "view"}) == "");
  CHECK(missing(help("evaluate"),
                {"APE", "RPE", "MAE", "Chamfer", "IoU", "F1", "outlier", "TULIP", "evo"}) == "");
  CHECK(missing(help("calibrate"), {".pcap", ".mcap", ".bin", ".pcd", ".ply", ".csv", ".txt"}) ==
        "");
}

}  // namespace hqslam::tools

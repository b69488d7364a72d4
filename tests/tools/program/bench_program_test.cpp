#include <sstream>

#include "hqslam/nn/instruction_set.h"
#include "tools/program/program.h"
#include "tools/program/untrained_weights.h"

namespace hqslam::test {
namespace {

/// The cells of the lines that begin with the words `first`, without these: the rows of this name
/// in all tables of a text, in their order.
std::vector<std::vector<std::string>> rows_of(const std::string& text, const std::string& first) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with(first + "  ")) continue;
    std::istringstream words(line.substr(first.size()));
    rows.emplace_back(std::istream_iterator<std::string>(words),
                      std::istream_iterator<std::string>());
  }
  return rows;
}

}  // namespace

TEST_CASE("bench measures every stage with 64, 16 and 16 upsampled rows, with one thread and two") {
  const std::string text = succeeds("bench --scans 12 --weights '{}'", untrained_file()).out;
  CAPTURE(text);
  for (const std::string name : {"64", "16", "16, du-or"}) {
    CAPTURE(name);
    const bool is_upsampled = name == "16, du-or";
    const auto rows = rows_of(text, name);
    REQUIRE(rows.size() == 4);
    for (const std::size_t i : {0, 1}) {
      const std::vector<std::string>& stages = rows[i];  // threads, upsampling, SLAM's
      const std::vector<std::string>& total = rows[2 + i];
      REQUIRE(stages.size() == 6);
      CHECK(stages[0] == std::to_string(i + 1));
      CHECK(is_upsampled == (stages[1] != "-"));
      for (const std::size_t stage : {2, 3, 5}) CHECK(std::stod(stages[stage]) > 0.0);
      CHECK(std::stod(stages[4]) >= 0.0);  // odometry runs where it can change a pose
      REQUIRE(total.size() == 5);          // threads, scans, median, 95 %, scans/s
      CHECK(total[0] == std::to_string(i + 1));
      CHECK(total[1] == "12");
      for (const std::size_t figure : {2, 3, 4}) CHECK(std::stod(total[figure]) > 0.0);
      if (is_upsampled) CHECK(std::stod(total[2]) > std::stod(stages[1]));
    }
  }
  const std::size_t network = text.find("du-or: whole network");
  REQUIRE(network != std::string::npos);
  double gmac = 0.0;
  REQUIRE(std::sscanf(text.c_str() + text.find("parameters, ", network), "parameters, %lf GMAC",
                      &gmac) == 1);
  CHECK(gmac > 0.01);
  for (const nn::InstructionSet set : nn::available_instruction_sets()) {
    const auto runs = rows_of(text.substr(network), std::string(nn::name(set)));
    REQUIRE(runs.size() == 2);
    for (const std::vector<std::string>& run : runs) {
      REQUIRE(run.size() == 6);  // threads, frames, frames/s, ms/frame, 95 %, GFLOP/s
      for (const std::size_t figure : {1, 2, 3, 5}) CHECK(std::stod(run[figure]) > 0.0);
    }
  }
}

TEST_CASE("bench refuses an instruction set that the processor lacks, before it measures") {
  setenv("HQSLAM_INSTRUCTION_SET", "mmx", 1);
  CHECK(holds(refused("bench"), "HQSLAM_INSTRUCTION_SET is 'mmx'"));
  unsetenv("HQSLAM_INSTRUCTION_SET");
}

}  // namespace hqslam::test

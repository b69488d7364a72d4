#include "compare/other_scans_comparison.h"

#include <algorithm>

#include "hqslam/core/error.h"
#include "pages/text_table.h"
#include "terminal/progress.h"

namespace hqslam::tools {

namespace {

using Score = OtherScansScore;

std::vector<Figure<Score>> figures() {
  return {
      {"right", "right_share", 1, 100.0, &Score::right_share},
      {"missing", "missing_share", 1, 100.0, &Score::missing_share},
      {"over linear", "over_linear", 1, 100.0, [](const Score& s) { return s.over_linear.mean; }},
      {"+-", "standard_error", 1, 100.0,
       [](const Score& s) { return s.over_linear.standard_error; }}};
}

}  // namespace

std::vector<OtherScansScore> compared_with_other_scans(std::vector<ComparedMethod> methods,
                                                       const RecordedDrive& drive,
                                                       const std::string& source) {
  std::vector<Score> scores;
  std::vector<PixelShares> shares;
  Progress progress("compare", std::ssize(methods), stderr, "methods");
  for (ComparedMethod& method : methods) {
    shares.push_back(
        pixel_shares(drive.scans, drive.sensor, drive.measured_rows,
                     [&](const RangeImage& rows) { return method.upsampler.run(rows).image; }));
    const std::size_t scans = shares.back().right.size();
    if (scans < kFewestScansOfGain) {
      throw Error(
          "{}: expected {} scans or more of which others measured something, found {}; give a "
          "longer drive, or a recording with rows between the measured ones",
          source, kFewestScansOfGain, scans);
    }
    scores.push_back(
        {method.name, mean_of(shares.back().right), mean_of(shares.back().missing), {}});
    progress.advance();
  }
  progress.finish();
  const auto linear = std::ranges::find(scores, "linear", &Score::method) - scores.begin();
  for (std::size_t i = 0; i < scores.size(); ++i) {
    scores[i].over_linear = gain_of(shares[linear].right, shares[i].right);
  }
  return scores;
}

std::string scores_text(const std::vector<OtherScansScore>& scores) {
  const auto method = [](const Score& score) { return score.method; };
  return printed_table(table_of(scores, "Other scans", figures(), method)) + "\n" +
         printed_definitions(
             {{"right", "%, within 0.1 m, of the computed pixels that other scans measured"},
              {"missing", "%, left empty, of those pixels"},
              {"over linear", "right less that of linear"},
              {"+-", "standard error of that, over blocks of ten scans"}}) +
         "\n";
}

nlohmann::ordered_json scores_json(const std::vector<OtherScansScore>& scores) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const Score& score : scores) {
    add_figures(score, figures(),
                json.emplace_back(nlohmann::ordered_json{{"method", score.method}}));
  }
  return json;
}

}  // namespace hqslam::tools

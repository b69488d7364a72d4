#include "report/stroke_font.h"

#include <algorithm>
#include <string_view>

namespace hqslam::tools {
namespace {

/// Two characters per point: x, then y ('a' and 'b' are 1 and 2 below the base line). A blank ends
/// a stroke.
struct GlyphText {
  char character;
  std::string_view strokes;
};

constexpr GlyphText kGlyphs[] = {
    {' ', ""},
    {'A', "002640 1333"},
    {'B', "00063645443303 3342413000"},
    {'C', "4536160501103041"},
    {'D', "00062644422000"},
    {'E', "46060040 0333"},
    {'F', "460600 0333"},
    {'G', "45361605011030414323"},
    {'H', "0006 4046 0343"},
    {'I', "1030 1636 2026"},
    {'J', "4641301001"},
    {'K', "0006 4602 1340"},
    {'L', "060040"},
    {'M', "0006234640"},
    {'N', "00064046"},
    {'O', "103041453616050110"},
    {'P', "00063645443303"},
    {'Q', "103041453616050110 2240"},
    {'R', "00063645443303 2340"},
    {'S', "453616050413334241301001"},
    {'T', "0646 2620"},
    {'U', "060110304146"},
    {'V', "062046"},
    {'W', "0610233046"},
    {'X', "0046 0640"},
    {'Y', "062346 2320"},
    {'Z', "06460040"},
    {'a', "4334140301103041 4440"},
    {'b', "0600 0314344341301001"},
    {'c', "4334140301103041"},
    {'d', "4640 4334140301103041"},
    {'e', "0242433414030110 1040"},
    {'f', "46362520 1434"},
    {'g', "4334140301103041 444a3b1b0a"},
    {'h', "0600 0314344340"},
    {'i', "2420 2626"},
    {'j', "343a2b1b 3636"},
    {'k', "0600 3401 1230"},
    {'l', "2620"},
    {'m', "0004 03142320 23344340"},
    {'n', "0004 0314344340"},
    {'o', "103041433414030110"},
    {'p', "040b 0314344341301001"},
    {'q', "444b 4334140301103041"},
    {'r', "0004 022434"},
    {'s', "4414031232413000"},
    {'t', "262130 1434"},
    {'u', "0401103041 4440"},
    {'v', "042044"},
    {'w', "0410233044"},
    {'x', "0044 0440"},
    {'y', "0420 441b"},
    {'z', "04440040"},
    {'0', "103041453616050110"},
    {'1', "152620 1030"},
    {'2', "05163645440040"},
    {'3', "0516364544334241301001 1333"},
    {'4', "30360242"},
    {'5', "460603334241301001"},
    {'6', "36160501103041423303"},
    {'7', "064610"},
    {'8', "13334445361605041302011030414233"},
    {'9', "10304145361605041343"},
    {'-', "1333"},
    {'+', "0343 2125"},
    {'.', "2020"},
    {',', "21201a"},
    {':', "2121 2424"},
    {'/', "0046"},
    {'(', "36252130"},
    {')', "16252110"},
    {'=', "0242 0444"},
    {'%', "0046 0606 4040"},
    {'_', "0a4a"},
};

constexpr std::string_view kBox = "0006464000";

constexpr double kSpace = 1.8;  ///< between letters
constexpr double kBlankAdvance = 3.2;

double y_of(char digit) { return digit == 'a' ? -1.0 : digit == 'b' ? -2.0 : digit - '0'; }

std::string_view text_of(char character) {
  for (const GlyphText& known : kGlyphs) {
    if (known.character == character) return known.strokes;
  }
  return kBox;
}

}  // namespace

Glyph glyph(char character) {
  const std::string_view text = text_of(character);
  Glyph result;
  double left = 4.0;
  double right = 0.0;
  for (std::size_t i = 0; i < text.size();) {
    if (i == 0 || text[i] == ' ') {
      result.strokes.emplace_back();
      i += text[i] == ' ' ? 1 : 0;
    }
    const double x = text[i] - '0';
    left = std::min(left, x);
    right = std::max(right, x);
    result.strokes.back().emplace_back(x, y_of(text[i + 1]));
    i += 2;
  }
  for (std::vector<Eigen::Vector2d>& stroke : result.strokes) {
    for (Eigen::Vector2d& point : stroke) point.x() -= left;
  }
  result.advance = text.empty() ? kBlankAdvance : right - left + kSpace;
  return result;
}

}  // namespace hqslam::tools

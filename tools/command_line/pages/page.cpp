#include "pages/page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "hqslam/core/error.h"
#include "pages/web_files.h"

namespace hqslam::tools {
namespace {

const std::string& web_file(std::string_view name) {
  const auto found = web_files().find(name);
  if (found == web_files().end()) throw Error("page {}: expected a file of tools/web", name);
  return found->second;
}

/// Replaces each element `before` FILE `after` by the file between `open` and `close`.
void put_files_into(std::string& html, std::string_view before, std::string_view after,
                    std::string_view open, std::string_view close) {
  for (std::size_t at = 0; (at = html.find(before, at)) != std::string::npos;) {
    const std::size_t name = at + before.size();
    const std::size_t end = html.find(after, name);
    const std::string file = fmt::format(
        "{}{}{}", open, web_file(std::string_view(html).substr(name, end - name)), close);
    html.replace(at, end + after.size() - at, file);
    at += file.size();
  }
}

template <typename Number>
std::string base64_of(std::span<const Number> values) {
  const auto bytes = std::as_bytes(values);
  return base64({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
}

}  // namespace

std::string page_html(std::string_view name, PageJson data) {
  data["version"] = HQSLAM_VERSION;
  std::string html = web_file(fmt::format("{}.html", name));
  put_files_into(html, R"(<link rel="stylesheet" href=")", R"(">)", "<style>\n", "</style>");
  put_files_into(html, R"(<script src=")", R"("></script>)", "<script>\n", "</script>");
  constexpr std::string_view kData = R"(id="data">)";
  const std::size_t place = html.find(kData) + kData.size();
  std::string text;
  for (const char c :
       data.dump(-1, ' ', /*ensure_ascii=*/true, PageJson::error_handler_t::replace)) {
    if (c == '<') {
      text += "\\u003c";
    } else {
      text += c;
    }
  }
  return html.insert(place, text);
}

std::string page_marker(std::string_view generator) {
  return fmt::format(R"(<meta name="generator" content="{}">)", generator);
}

std::string short_name(const std::string& path) {
  const std::filesystem::path file(path);
  return (file.parent_path().filename() / file.filename()).string();
}

std::string base64(std::span<const std::uint8_t> bytes) {
  constexpr std::string_view kAlphabet =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t present = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) group = group << 8U | (k < present ? bytes[i + k] : 0U);
    for (std::size_t k = 0; k < 4; ++k) {
      text += k <= present ? kAlphabet[group >> (18 - 6 * k) & 63U] : '=';
    }
  }
  return text;
}

PageJson f32_block(std::span<const float> values) { return {{"f32", base64_of(values)}}; }

PageJson f32_block(const std::vector<double>& values) {
  return f32_block(std::vector<float>(values.begin(), values.end()));
}

PageJson u8_block(std::span<const std::uint8_t> values) { return {{"u8", base64(values)}}; }

PageJson u16_block(std::span<const float> values, float low, float high) {
  constexpr float kMost = 65535.0F;
  const float step = high > low ? (high - low) / kMost : 1.0F;
  std::vector<std::uint16_t> steps;
  steps.reserve(values.size());
  for (const float value : values) {
    const float n = std::isfinite(value) ? std::round((value - low) / step) : 0.0F;
    steps.push_back(static_cast<std::uint16_t>(std::clamp(n, 0.0F, kMost)));
  }
  return {{"u16", base64_of(std::span<const std::uint16_t>(steps))}, {"low", low}, {"step", step}};
}

PageJson share_block(std::span<const float> shares) {
  constexpr float kMost = 255.0F;
  std::vector<std::uint8_t> steps;
  steps.reserve(shares.size());
  for (const float share : shares) {
    const float n = std::isfinite(share) ? std::round(share * kMost) : 0.0F;
    steps.push_back(static_cast<std::uint8_t>(std::clamp(n, 0.0F, kMost)));
  }
  return {{"u8", base64(steps)}, {"low", 0.0F}, {"step", 1.0F / kMost}};
}

PageJson range_block(const RangeImage& image) {
  float high_m = 1.0F;
  for (const float range_m : image.range_m) {
    if (std::isfinite(range_m)) high_m = std::max(high_m, range_m);
  }
  return u16_block(image.range_m, 0.0F, high_m);
}

}  // namespace hqslam::tools

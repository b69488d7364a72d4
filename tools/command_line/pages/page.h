#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hqslam/core/range_image.h"

namespace hqslam::tools {

using PageJson = nlohmann::ordered_json;

/// tools/web/NAME.html with its styles and scripts in it, and with `data` and the program's version
/// for the scripts to show. The page needs no other file and no network. Text in `data` stays text:
/// nothing in it ends the script, and bytes that are not UTF-8 become U+FFFD.
std::string page_html(std::string_view name, PageJson data);

/// In the head of every page of that name: `generator`, such as "hqslam view", is the content of
/// the template's <meta name="generator">.
std::string page_marker(std::string_view generator);

/// A path without most of it: "kitti_drive_0005/velodyne".
std::string short_name(const std::string& path);

/// Bytes as base64 (RFC 4648, with padding).
std::string base64(std::span<const std::uint8_t> bytes);

/// Numbers as the bytes of a JavaScript typed array in base64: {"f32": ...} and {"u8": ...}.
/// Scripts read them with numbersOf().
PageJson f32_block(std::span<const float> values);
PageJson f32_block(const std::vector<double>& values);
PageJson u8_block(std::span<const std::uint8_t> values);
/// Whole numbers n of 16 bits that stand for low + n * step, so that `high` is the largest: half as
/// long, off by half a step at most. What is not finite becomes `low`.
PageJson u16_block(std::span<const float> values, float low, float high);
/// Shares of 0 to 1 in 256 steps, enough for a grey.
PageJson share_block(std::span<const float> shares);
/// Ranges of an image: 0 stays 0, no return.
PageJson range_block(const RangeImage& image);

}  // namespace hqslam::tools

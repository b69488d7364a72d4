#pragma once

#include <nlohmann/json.hpp>
#include <string_view>

#include "testing.h"

namespace hqslam::test {

/// The JSON of a page.
inline nlohmann::json data_of(const std::string& html) {
  const std::string begin = "id=\"data\">";
  const std::size_t at = html.find(begin) + begin.size();
  return nlohmann::json::parse(html.substr(at, html.find("</script>", at) - at));
}

/// The bytes that base64 text stands for.
inline std::vector<std::uint8_t> bytes_of(const std::string& text) {
  constexpr std::string_view kAlphabet =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<std::uint8_t> bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char letter : text) {
    if (letter == '=') break;
    bits = bits << 6U | static_cast<std::uint32_t>(kAlphabet.find(letter));
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes.push_back(static_cast<std::uint8_t>(bits >> count & 255U));
  }
  return bytes;
}

/// The numbers of a block, as scripts read them (numbersOf in tools/web/base.js).
inline std::vector<float> numbers_of(const nlohmann::json& block) {
  std::vector<float> numbers;
  const auto read = [&](const char* kind, auto number) {
    const std::vector<std::uint8_t> bytes = bytes_of(block[kind].get<std::string>());
    for (std::size_t i = 0; i + sizeof number <= bytes.size(); i += sizeof number) {
      std::memcpy(&number, bytes.data() + i, sizeof number);
      numbers.push_back(static_cast<float>(number));
    }
  };
  if (block.contains("f32")) read("f32", 0.0F);
  if (block.contains("u8")) read("u8", std::uint8_t{0});
  if (block.contains("u16")) read("u16", std::uint16_t{0});
  if (!block.contains("step")) return numbers;
  for (float& number : numbers) {
    number = block["low"].get<float>() + number * block["step"].get<float>();
  }
  return numbers;
}

}  // namespace hqslam::test

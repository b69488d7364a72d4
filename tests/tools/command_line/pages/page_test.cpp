#include "pages/page.h"

#include <regex>

#include "pages/web_files.h"
#include "tools/page_data.h"
#include "tools/parts_of_text.h"

namespace hqslam::tools {
namespace {

std::vector<std::string> page_names() {
  std::vector<std::string> names;
  for (const auto& [name, text] : web_files()) {
    if (name.ends_with(".html")) names.push_back(name.substr(0, name.size() - 5));
  }
  return names;
}

}  // namespace

TEST_CASE("every page has its styles, scripts and data in it, and needs no other file") {
  CHECK(page_names().size() >= 8);
  for (const std::string& name : page_names()) {
    CAPTURE(name);
    const std::string html = page_html(name, {{"title", "a title"}});
    CHECK(html.starts_with("<!doctype html>"));
    CHECK(html.ends_with("</html>\n"));
    CHECK_FALSE(std::regex_search(html, std::regex("(src|href)=\"(?!data:)")));
    CHECK_FALSE(std::regex_search(html, std::regex("@import|url\\((?!#)")));
    CHECK(holds(html.substr(0, 4096), "<meta name=\"generator\" content=\"hqslam"));
    CHECK(data_of(html)["title"] == "a title");
    CHECK_FALSE(data_of(html)["version"].get<std::string>().empty());
  }
  CHECK(refused_with([] { page_html("no such page", {}); }, "no such page"));
}

TEST_CASE("hostile text stays text: it ends no page's script, and what is not UTF-8 is replaced") {
  const std::string hostile = "</script><script>alert(1)</script><!--";
  for (const std::string& name : page_names()) {
    const std::string html = page_html(name, {{"title", hostile}, {"other", "a\xFF"}});
    CHECK_FALSE(holds(html, "alert(1)</script>"));
    CHECK(count(html, "</script>") == count(page_html(name, {}), "</script>"));
    CHECK(data_of(html)["title"] == hostile);
    CHECK(data_of(html)["other"] == "a\xEF\xBF\xBD");
  }
}

TEST_CASE("base64 is that of RFC 4648") {
  const auto text_of = [](const std::string& text) {
    return base64({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  };
  CHECK(text_of("") == "");
  CHECK(text_of("f") == "Zg==");
  CHECK(text_of("fo") == "Zm8=");
  CHECK(text_of("foobar") == "Zm9vYmFy");
}

TEST_CASE("blocks of numbers keep what they are given, of 16 bits within half a step") {
  CHECK(numbers_of(f32_block(std::vector<double>{0.5, -3.0})) == std::vector<float>{0.5F, -3.0F});
  CHECK(std::isnan(numbers_of(f32_block(std::vector<float>{std::nanf("")}))[0]));
  RangeImage image(1, 4);
  image.range_m = {0.0F, 1.234F, 98.765F, std::nanf("")};
  const std::vector<float> ranges_m = numbers_of(range_block(image));
  CHECK(ranges_m[0] == 0.0F);  // no return
  CHECK(ranges_m[1] == doctest::Approx(1.234).epsilon(1e-3));
  CHECK(ranges_m[2] == doctest::Approx(98.765).epsilon(1e-5));
  CHECK(ranges_m[3] == 0.0F);
  CHECK(numbers_of(u16_block(std::vector<float>{2.0F}, 2.0F, 2.0F)) ==
        std::vector<float>{2.0F});  // a scale without extent
}

}  // namespace hqslam::tools

#include "files/content_hash.h"

#include <doctest/doctest.h>

#include "error_message.h"
#include "file_contents.h"
#include "temporary_directory.h"

namespace hqslam::tools {

TEST_CASE("the hash is FNV-1a: its authors' test vectors") {
  CHECK(text_hash("") == "cbf29ce484222325");
  CHECK(text_hash("a") == "af63dc4c8601ec8c");
  CHECK(text_hash("foobar") == "85944171f73967e8");
}

TEST_CASE("a file has the hash of its bytes, however many there are") {
  const test::TemporaryDirectory folder;
  const std::string text(200000, '\xf3');
  test::write_file(folder.file("bytes"), text);
  CHECK(content_hash(folder.file("bytes")) == text_hash(text));
  CHECK(test::one_line_with(test::error_message([&] { content_hash(folder.file("none")); }),
                            folder.file("none")));
}

}  // namespace hqslam::tools

#include "files/content_hash.h"

#include "testing.h"

namespace hqslam::tools {

TEST_CASE("a file has the hash of its bytes, which is FNV-1a: its authors' test vectors") {
  CHECK(text_hash("") == "cbf29ce484222325");
  CHECK(text_hash("a") == "af63dc4c8601ec8c");
  CHECK(text_hash("foobar") == "85944171f73967e8");
  const TemporaryDirectory folder;
  const std::string text(200000, '\xf3');
  write_file(folder.file("bytes"), text);
  CHECK(content_hash(folder.file("bytes")) == text_hash(text));
  CHECK(refused_with([&] { content_hash(folder.file("none")); }, folder.file("none")));
}

TEST_CASE("a folder is known by the names and the bytes of its files") {
  const TemporaryDirectory folder;
  const std::string inside = folder.file("folder");
  std::filesystem::create_directories(inside + "/below");
  std::set<std::string> hashes = {folder_hash(inside)};
  write_file(inside + "/below/a", "1");
  hashes.insert(folder_hash(inside));
  write_file(inside + "/below/a", "2");
  hashes.insert(folder_hash(inside));
  std::filesystem::rename(inside + "/below/a", inside + "/a");
  hashes.insert(folder_hash(inside));
  CHECK(hashes.size() == 4);
  CHECK(folder_hash(inside) == folder_hash(inside + "/"));
  std::filesystem::copy(inside, folder.file("elsewhere"));
  CHECK(folder_hash(inside) == folder_hash(folder.file("elsewhere")));
}

}  // namespace hqslam::tools

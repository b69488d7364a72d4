#include "terminal/progress.h"

#include "testing.h"

namespace hqslam::tools {

TEST_CASE("the progress bar is half full at half time and says rate and time left") {
  const ProgressState state{"slam 64x1024", 40, 80, 2.0};
  CHECK(progress_bar(state) ==
        "slam 64x1024 [############............]  50 %  40/80 scans  20.0 scans/s  2 s left");
}

TEST_CASE("before the first scan there is no rate; a finished job says how long it took") {
  CHECK(progress_line({"slam", 80, 80, 100.0}) == "slam: 80/80 scans  0.8 scans/s  1 min 40 s");
  CHECK(progress_line({"slam", 0, 80, 0.0}) == "slam: 0/80 scans");
  CHECK(progress_bar({"slam", 0, 0, 0.0}) == "slam [########################] 100 %  0/0 scans");
}

TEST_CASE("a stream that is no terminal gets plain lines") {
  std::FILE* stream = std::tmpfile();
  REQUIRE(stream != nullptr);
  Progress progress("slam", 3, stream);
  progress.update(3);
  progress.finish();
  std::rewind(stream);
  std::string text(200, '\0');
  text.resize(std::fread(text.data(), 1, text.size(), stream));
  std::fclose(stream);
  CHECK(text.rfind("slam: 3/3 scans", 0) == 0);
  CHECK(text.back() == '\n');
  CHECK(text.find_first_of("\r\x1b[") == std::string::npos);
}

}  // namespace hqslam::tools

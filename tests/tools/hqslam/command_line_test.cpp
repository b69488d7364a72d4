#include <iterator>
#include <sstream>

#include "product.h"
#include "tools/command_line/parsed_options.h"

namespace hqslam::tools {

TEST_CASE("the page of live is served to this computer alone, at port 8642 or another") {
  const auto plain = parsed_options<LiveOptions>({"live", "--sensor", "vlp-16", "--out", "x"});
  CHECK_FALSE(plain.view);
  CHECK(plain.view_address == "127.0.0.1");
  CHECK(parsed_options<LiveOptions>({"live", "--sensor", "vlp-16", "--out", "x", "--view"}).view ==
        8642);
}

TEST_CASE("what makes no sense is refused") {
  for (const std::string given :
       {"run", "run /", "run / --out x --rows 0", "run / --out x --rows many",
        "run / --out x --row-order sideways", "run / --out x --threads 0",
        "run / --out x --reference /no/such/file", "run / --out x --upsample cubic",
        "upsample / --method linear", "evaluate /no/such/file /no/such/file",
        "live --sensor vlp-16", "live --sensor vlp-16 --out x --port 70000",
        "live --sensor vlp-16 --out x --view-address 0.0.0.0", "view /", "view --out x",
        "view / --out x --scan -1"}) {
    CAPTURE(given);
    std::istringstream words(given);
    const std::vector<std::string> arguments{std::istream_iterator<std::string>(words), {}};
    CHECK_THROWS_AS(parse(product(), arguments), CLI::ParseError);
  }
}

}  // namespace hqslam::tools

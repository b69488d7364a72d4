#include "hqslam/core/npz.h"
#include "hqslam/nn/super_resolver.h"
#include "tools/program/program.h"
#include "tools/program/untrained_weights.h"

namespace hqslam::test {
namespace {

/// What another program would have: the arrays of a network and its description. The sensor has few
/// columns, so that the network runs at once.
struct Foreign {
  TemporaryDirectory folder;
  nn::Weights weights = untrained_weights(preset_with("os1-64", 128), "du-mix");
  std::string arrays = folder.file("arrays.npz");
  std::string description = folder.file("network.json");
  std::string packed = folder.file("packed.npz");

  explicit Foreign(bool with_self_test, float range_error_m = 0.0F) {
    write_weights(packed, weights);
    NpzArrays all = read_npz(packed);
    all.erase("description");
    if (!with_self_test) {
      all.erase("self_test.measured");
      all.erase("self_test.expected");
    } else if (range_error_m != 0.0F) {
      for (float& range_m : weights.self_test.expected.range_m) range_m += range_error_m;
      all["self_test.expected"] =
          npz_array(weights.self_test.expected.range_m, all["self_test.expected"].shape);
    }
    write_npz(arrays, all);
    std::ofstream(description) << nn::network_json(weights.description);
    fs::remove(packed);
  }

  ProgramResult pack() const {
    return run_hqslam("weights pack '{}' '{}' --out '{}'", arrays, description, packed);
  }
};

}  // namespace

TEST_CASE("weights pack makes weights that load, with a self-test of its own") {
  const Foreign foreign(false);
  const ProgramResult result = foreign.pack();
  REQUIRE(result.status == 0);
  CHECK(missing(result.out, {"du-mix", "no self-test beside them"}) == "");
  const nn::Weights packed = nn::read_weights(foreign.packed);
  CHECK(packed.parameters == foreign.weights.parameters);
  CHECK_NOTHROW(nn::SuperResolver::checked(packed, "packed"));
  const ProgramResult shown = succeeds("weights show '{}'", foreign.packed);
  CHECK(missing(shown.out, {fmt::format("{} parameters", packed.parameters.size()),
                            "layers.0.encoder.0.weight", "arrays.npz"}) == "");
}

TEST_CASE("weights pack takes a self-test that is there, and refuses arrays that fail it") {
  const ProgramResult result = Foreign(true).pack();
  CHECK(result.status == 0);
  CHECK(holds(result.out, "which give what the self-test beside them expects"));

  const Foreign bad(true, 1.0F);
  CHECK(holds(refusal(bad.pack()), "self-test"));
  CHECK_FALSE(fs::exists(bad.packed));
}

}  // namespace hqslam::test

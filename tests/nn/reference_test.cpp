#include "hqslam/nn/reference/reference.h"

#include "small_network.h"

namespace hqslam::nn {
namespace {

HqsPlan supported_du_or() {
  HqsPlan plan = small_du_or();
  plan.filter.min_pixels = 12;
  plan.filter.support_share = 0.05F;
  return plan;
}

ReferenceTrace reference_of(const NetworkDescription& description,
                            const ReferenceOptions& options = {}) {
  const std::vector<float> parameters = large_parameters(description, 9);
  return reference_trace(description, std::vector<double>(parameters.begin(), parameters.end()),
                         measured_scene(description), options);
}

/// Holds a trace's tensors against those of the reference; the names of all that it held.
std::set<std::string> compared_with_reference(const NetworkDescription& description,
                                              const std::vector<float>& parameters,
                                              const Trace& trace) {
  std::set<std::string> compared;
  for (const ReferenceDifference& difference :
       differences_from_reference(description, parameters, trace)) {
    CAPTURE(difference.name);
    CAPTURE(difference.largest);
    const TracedTensor& tensor = trace.tensor(difference.name);
    float scale = 1.0F;
    for (const float value : tensor.all()) scale = std::max(scale, std::fabs(value));
    CHECK(difference.largest < 1e-4 * scale);
    CHECK(difference.root_mean_square <= difference.largest);
    CHECK(difference.unit == tensor.unit);
    compared.insert(difference.name);
  }
  return compared;
}

}  // namespace

TEST_CASE("every network's inner tensors are those of the reference, name by name") {
  using Traced = std::pair<NetworkDescription, RecalledImage>;
  for (const auto& [description, recalled] :
       {Traced{supported_du_or(), {}}, Traced{small_simple_du(), {}}, Traced{small_du_mix(), {}},
        Traced{small_du_mix_with_memory(), {}},
        Traced{small_du_mix_with_memory(), recalled_scene()}}) {
    CAPTURE(name(description));
    const std::vector<float> parameters = large_parameters(description, 9);
    const Trace trace =
        made(description, parameters, 2)->trace({measured_scene(description), recalled});
    CHECK(trace.has("recalled") == !recalled.is_empty());
    const std::set<std::string> compared = compared_with_reference(description, parameters, trace);
    for (const TracedTensor& tensor : trace.tensors()) {
      CAPTURE(tensor.name);
      const bool given = tensor.name == "measured" || tensor.name.starts_with("recalled") ||
                         tensor.name.ends_with(".penalty") || tensor.name.ends_with(".rejected");
      CHECK(compared.contains(tensor.name) == !given);
    }
  }
}

TEST_CASE("the reference's breadth-first search rejects what the fast filter rejects") {
  const HqsPlan plan = supported_du_or();
  const Trace trace = made(plan, large_parameters(plan, 9), 2)->trace(measured_scene(plan));
  const ReferenceTrace reference = reference_of(plan);  // with a search of its own
  for (const char* name : {"layers.0.rejected", "layers.1.rejected", "layers.2.rejected"}) {
    CHECK(std::ranges::equal(reference.tensor(name).all(), trace.tensor(name).all()));
  }
}

TEST_CASE("a rejected pixel that is 0, as in the paper, halves its range in the next layer") {
  HqsPlan plan = supported_du_or();
  const ReferenceTrace ours = reference_of(plan);
  plan.rejected_pixel = RejectedPixel::kZero;
  const ReferenceTrace literal = reference_of(plan);
  const std::span<const double> rejected = literal.tensor("layers.0.rejected").all();
  const std::span<const double> z = literal.tensor("layers.0.z").all();
  const std::span<const double> h = literal.tensor("layers.1.h").all();
  int ghosts = 0;
  for (std::size_t i = 0; i < rejected.size(); ++i) {
    if (rejected[i] == 0.0) continue;
    CHECK(h[i] == doctest::Approx(0.5 * z[i]));
    ++ghosts;
  }
  CHECK(ghosts > 10);
  for (std::size_t i = 0; i < rejected.size(); ++i) {
    if (rejected[i] != 0.0) CHECK(ours.tensor("layers.1.h").all()[i] == doctest::Approx(z[i]));
  }
}

TEST_CASE("with Q of Z, Y is Z where the filter keeps it and H where it does not") {
  HqsPlan plan = supported_du_or();
  plan.filtered_iterate = FilteredIterate::kZ;
  const ReferenceTrace trace = reference_of(plan);
  const std::span<const double> rejected = trace.tensor("layers.1.rejected").all();
  int count = 0;
  for (std::size_t i = 0; i < rejected.size(); ++i) {
    const char* from = rejected[i] != 0.0 ? "layers.1.h" : "layers.1.z";
    CHECK(trace.tensor("layers.1.y").all()[i] == trace.tensor(from).all()[i]);
    count += rejected[i] != 0.0;
  }
  CHECK(count > 10);
}

TEST_CASE("the reference refuses what does not fit in one line") {
  const HqsPlan plan = small_du_or();
  const std::vector<double> none;
  const RangeImage measured = measured_scene(plan);
  CHECK(refused_with([&] { reference_trace(plan, none, measured); }, "0 parameters"));
  CHECK(refused_with([&] { reference_trace(plan, none, RangeImage(16, 64)); }, "16 x 64"));
  CHECK(refused_with([&] { reference_of(plan, {.rejected = {{1}}}); }, "a mask of 1"));
}

TEST_CASE("DU-Mix for any beams equals the reference, whatever rows are measured") {
  using Observed = std::pair<RowSelection, bool>;
  for (const auto& [rows, with_memory] :
       {Observed{{3, 4}, false}, Observed{{1, 4}, false}, Observed{{0, 2}, false},
        Observed{{3, 4}, true}, Observed{{1, 2}, true}}) {
    CAPTURE(rows.offset);
    CAPTURE(with_memory);
    const NetworkDescription description = small_any_beams(rows, with_memory);
    const std::vector<float> parameters = large_start(description);
    const RangeImage measured = select_rows(small_scene(), rows);
    for (const InstructionSet instruction_set : available_instruction_sets()) {
      CAPTURE(name(instruction_set));
      const Trace trace = made(description, parameters, 1, instruction_set)
                              ->trace({measured, with_memory ? recalled_scene() : RecalledImage()});
      const auto differences = differences_from_reference(description, parameters, trace);
      CHECK(differences.size() > (with_memory ? 10 : 8));
      for (const ReferenceDifference& difference : differences) {
        CAPTURE(difference.name);
        CHECK(difference.largest < 2e-3);
      }
    }
  }
}

}  // namespace hqslam::nn

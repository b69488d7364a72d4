#include "hqslam/nn/instruction_set.h"

#include "testing.h"

namespace hqslam::nn {
namespace {

constexpr const char* kVariable = "HQSLAM_INSTRUCTION_SET";

/// Sets the variable (or unsets it) until the end of the scope.
class Setting {
 public:
  explicit Setting(const std::optional<std::string>& value) {
    if (const char* before = std::getenv(kVariable)) before_ = before;
    set(value);
  }
  ~Setting() { set(before_); }
  Setting(const Setting&) = delete;
  Setting& operator=(const Setting&) = delete;

 private:
  static void set(const std::optional<std::string>& value) {
    if (value) {
      setenv(kVariable, value->c_str(), 1);
    } else {
      unsetenv(kVariable);
    }
  }
  std::optional<std::string> before_;
};

}  // namespace

TEST_CASE("the widest instruction set is chosen, or that which the variable names") {
  const Setting none(std::nullopt);
  CHECK(chosen_instruction_set() == available_instruction_sets().back());
  for (const InstructionSet instruction_set : available_instruction_sets()) {
    const Setting setting(std::string(name(instruction_set)));
    CHECK(chosen_instruction_set() == instruction_set);
  }
}

TEST_CASE("an unknown name is refused with the list of those that there are") {
  const Setting setting("sse9");
  const std::string message = error_message([] { chosen_instruction_set(); });
  CHECK(one_line_with(message, kVariable, "'sse9'", "portable"));
  for (const InstructionSet instruction_set : available_instruction_sets()) {
    CHECK(message.find(name(instruction_set)) != std::string::npos);
  }
}

}  // namespace hqslam::nn

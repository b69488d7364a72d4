#include <fmt/format.h>

#include "denoiser.h"
#include "hqslam/core/error.h"
#include "plain_denoiser.h"
#include "u_shaped_denoiser.h"

namespace hqslam::nn {
namespace {

std::vector<NamedDenoiser>& registry() {
  static std::vector<NamedDenoiser> denoisers{
      {"u-shaped", read_u_shaped_denoiser},
      {"plain", read_plain_denoiser},
  };
  return denoisers;
}

}  // namespace

const std::vector<NamedDenoiser>& denoisers() { return registry(); }

void add_denoiser(const NamedDenoiser& denoiser) { registry().push_back(denoiser); }

void check_image(const DenoiserDescription& description, int rows, int columns) {
  const TileSize multiple = description.multiple;
  if (rows % multiple.rows != 0 || columns % multiple.columns != 0) {
    throw Error(fmt::format("denoiser: an image of {} x {}, expected multiples of {} x {}", rows,
                            columns, multiple.rows, multiple.columns));
  }
}

std::unique_ptr<Denoiser> make_denoiser(const DenoiserDescription& description, int rows,
                                        int columns, InstructionSet instruction_set, int threads) {
  check_image(description, rows, columns);
  return description.make(rows, columns, instruction_set, threads);
}

std::unique_ptr<Denoiser> smallest_denoiser(const DenoiserDescription& description) {
  return description.make(description.multiple.rows, description.multiple.columns,
                          InstructionSet::kPortable, 1);
}

}  // namespace hqslam::nn

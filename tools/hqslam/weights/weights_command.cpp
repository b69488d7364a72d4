#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "files/result_files.h"
#include "hqslam/core/error.h"
#include "hqslam/core/json_fields.h"
#include "hqslam/core/whole_file.h"
#include "hqslam/nn/network.h"
#include "hqslam/nn/network_json.h"
#include "hqslam/nn/weights_file.h"
#include "hqslam/pipeline/upsampler.h"
#include "product.h"
#include "terminal/command_options.h"
#include "terminal/terminal.h"

namespace hqslam::tools {
namespace {

struct WeightsOptions {
  std::string show;  ///< the weights file of `weights show`; empty: `weights pack`
  std::string arrays;
  std::string description;
  std::string out;
};

/// The network that a description file names: a network alone, or a recipe of hqslam-lab train.
nn::NetworkDescription described_network(const std::string& path) {
  const std::string text = whole_file(path, "a network's description (.json)", 1U << 20U);
  check_json_limits(text, path);
  const auto json = nlohmann::ordered_json::parse(text, nullptr, false);
  if (json.is_object() && json.contains("network")) {
    return nn::network_from_json(json["network"].dump(), path + ": network");
  }
  return nn::network_from_json(text, path);
}

/// Measured rows to try the network on: level ground 1.8 m below the sensor between walls 8 m to
/// its left and right, as far as the sensor's range.
RangeImage sample_scan(const nn::NetworkDescription& network) {
  constexpr double kHeight_m = 1.8;
  constexpr double kWall_m = 8.0;
  const SensorModel sensor = select_rows(network.sensor, network.measured_rows);
  RangeImage image(sensor.rows(), sensor.columns);
  for (int row = 0; row < sensor.rows(); ++row) {
    for (int column = 0; column < sensor.columns; ++column) {
      const double elevation_rad = sensor.beam_elevation_rad[row];
      const double sideways =
          std::abs(std::cos(elevation_rad) * std::sin(sensor.azimuth_rad(row, column)));
      const double downwards = -std::sin(elevation_rad);
      const double range_m =
          std::min(kHeight_m / std::max(downwards, 1e-9), kWall_m / std::max(sideways, 1e-9));
      if (range_m < sensor.max_range_m) image.at(row, column) = static_cast<float>(range_m);
    }
  }
  return image;
}

std::unique_ptr<nn::Network> network_with(const nn::Weights& weights) {
  auto network = nn::make_network(weights.description, weights.description.sensor.columns,
                                  nn::chosen_instruction_set(), 1);
  network->set_parameters(weights.parameters);
  return network;
}

bool is_weights_file(const std::string& path) {
  try {
    nn::read_weights(path);
    return true;
  } catch (const Error&) {
    return false;
  }
}

int pack(const WeightsOptions& options) {
  guard_output_file(options.out, {options.arrays, options.description}, is_weights_file);
  nn::Weights weights;
  weights.description = described_network(options.description);
  nn::ForeignArrays foreign = nn::read_foreign_arrays(options.arrays, weights.description);
  weights.parameters = std::move(foreign.parameters);
  const std::string arrays_name = std::filesystem::path(options.arrays).filename().string();
  weights.training = nlohmann::ordered_json{{"packed_from", arrays_name}}.dump();
  const bool checked = foreign.self_test.has_value();
  const auto network = network_with(weights);
  if (checked) {
    constexpr float kForeignTolerance = 1e-3F;
    nn::check_self_test(*network, weights.description, *foreign.self_test, options.arrays,
                        kForeignTolerance);
  }
  // As this program computes it, so that the file's own check need not allow for another's
  // rounding.
  weights.self_test = nn::make_self_test(
      *network, checked ? foreign.self_test->measured : sample_scan(weights.description));
  nn::write_weights(options.out, weights);
  to_stdout("{}: {}, {} parameters, {}\n", options.out, nn::name(weights.description),
            weights.parameters.size(),
            checked ? "which give what the self-test beside them expects"
                    : "no self-test beside them: one was made of what they give");
  return kOk;
}

void print_arrays(const nn::Weights& weights) {
  const std::vector<nn::ParameterShape> arrays = nn::parameter_shapes(weights.description);
  std::size_t width = 5;
  for (const nn::ParameterShape& array : arrays) width = std::max(width, array.name.size());
  to_stdout("{:<{}}  {:<18} {:>10} {:>10}\n", "array", width, "shape", "mean", "deviation");
  auto next = weights.parameters.begin();
  for (const nn::ParameterShape& array : arrays) {
    const auto end = next + array.elements();
    double sum = 0.0;
    double squares = 0.0;
    for (auto value = next; value != end; ++value) {
      sum += *value;
      squares += static_cast<double>(*value) * *value;
    }
    const auto count = static_cast<double>(array.elements());
    const double mean = sum / count;
    to_stdout("{:<{}}  {:<18} {:>10.4f} {:>10.4f}\n", array.name, width,
              fmt::format("{}", fmt::join(array.shape, " x ")), mean,
              std::sqrt(std::max(0.0, squares / count - mean * mean)));
    next = end;
  }
}

/// The names of the installed files, without .npz.
std::vector<std::string> installed_stems() {
  std::vector<std::string> stems;
  for (const std::string& name : pipeline::installed_weights_names()) {
    for (const std::filesystem::path file : pipeline::installed_weights_files(name)) {
      stems.push_back(file.stem().string());
    }
  }
  return stems;
}

int show(const std::string& given) {
  const std::string path = pipeline::installed_weights(given + ".npz").value_or(given);
  const nn::Weights weights = nn::read_weights(path);
  const nn::NetworkDescription& d = weights.description;
  const auto network = network_with(weights);
  nn::check_self_test(*network, d, weights.self_test, path);
  to_stdout(
      "{}: {}, {}{}: rows {}, {}, ... of {} x {} measured\n"
      "{} parameters, {:.3f} GMAC a scan; self-test passed\n\n",
      path, nn::name(d), nn::fits_any_sensor(d) ? "for any sensor; here " : "", d.sensor.name,
      d.measured_rows.offset, d.measured_rows.offset + d.measured_rows.stride, d.sensor.rows(),
      d.sensor.columns, weights.parameters.size(),
      static_cast<double>(network->multiply_adds()) * 1e-9);
  print_arrays(weights);
  to_stdout("\ndescription\n{}\ntraining\n{}\n", nn::network_json(d),
            nlohmann::ordered_json::parse(weights.training).dump(1));
  std::filesystem::path card = path;
  card.replace_extension(".md");
  if (std::filesystem::exists(card)) to_stdout("\nits card: {}\n", card.string());
  return kOk;
}

void declare(CLI::App& app, WeightsOptions& options) {
  Command command =
      add_command(app, "weights", "Show a weights file, or make one from another program's arrays");
  const OptionRules read = {.required = true, .given = Given::kFile};
  command.subcommand("show", "Print the contents of a weights file")
      .option("weights", &options.show, "Weights file, or the name of one that is installed",
              {.required = true, .given = Given::kFile, .one_of = installed_stems()});
  Command packed = command.subcommand(
      "pack", "Make a weights file of arrays that another program has trained",
      "Names and shapes of the arrays: nn/README.md, or hqslam weights show. If the arrays\n"
      "self_test.measured (measured rows) and self_test.expected (all rows; metres, 0 = no "
      "return)\n"
      "are there, the network must give the one for the other; otherwise they are made.");
  packed
      .option("arrays", &options.arrays,
              "The network's arrays (.npz), as numpy.savez writes a PyTorch state dict", read)
      .option("description", &options.description,
              "The network (.json): what \"network\" is in a recipe, or the recipe", read)
      .option("--out", &options.out, "Weights file to write", {.required = true});
}

int run(const WeightsOptions& options) {
  return options.show.empty() ? pack(options) : show(options.show);
}

}  // namespace

void add_weights(CLI::App& app, Chosen& chosen) { add_subcommand<WeightsOptions>(app, chosen); }

}  // namespace hqslam::tools

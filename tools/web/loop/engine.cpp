// The engine for a page: what is compiled to WebAssembly (build.sh) and called from loop.html.
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "hqslam/core/error.h"
#include "hqslam/nn/network_json.h"
#include "hqslam/nn/super_resolver.h"
#include "hqslam/nn/trace.h"
#include "inspect/what_if.h"

namespace {

hqslam::nn::Weights trained;
std::optional<hqslam::nn::SuperResolver> network;
hqslam::nn::Trace trace;
hqslam::RangeImage result;
std::string message;

/// What went wrong, for the page; empty: nothing.
template <typename Work>
const char* message_of(const Work& work) {
  message.clear();
  try {
    work();
  } catch (const std::exception& error) {
    message = error.what();
  }
  return message.c_str();
}

}  // namespace

extern "C" {

/// The names of the arrays of parameters in their order, as JSON, or what is wrong with the
/// description (JSON, the field "network" of a weights file).
const char* parameter_names(const char* description) {
  std::string names;
  message_of([&] {
    trained.description = hqslam::nn::network_from_json(description, "weights");
    nlohmann::json list;
    for (const auto& shape : hqslam::nn::parameter_shapes(trained.description)) {
      list.push_back(shape.name);
    }
    names = list.dump();
  });
  message = message.empty() ? names : message;
  return message.c_str();
}

/// All arrays one after the other.
void set_parameters(const float* values, int count) {
  trained.parameters.assign(values, values + count);
}

/// change: as of hqslam inspect --what-if; empty: the network as it was trained.
const char* change_network(const char* change) {
  return message_of([&] {
    const bool as_trained = *change == '\0';
    network.emplace(as_trained ? trained : hqslam::tools::what_if(trained, change),
                    hqslam::nn::SuperResolverOptions{.threads = 1});
  });
}

/// Upsamples the measured rows, in metres. traced: image() gives inner tensors, too.
const char* upsample(const float* measured_m, int rows, int columns, int traced) {
  return message_of([&] {
    hqslam::RangeImage measured(rows, columns);
    measured.range_m.assign(measured_m, measured_m + measured.range_m.size());
    result = network->run(measured, traced != 0 ? &trace : nullptr).image;
  });
}

/// The result's ranges in metres, rows x columns.
const float* result_ranges() { return result.range_m.data(); }

/// A tensor of the last traced scan, such as "layers.2.z"; null: there is none.
const float* tensor(const char* name) {
  return trace.has(name) ? trace.tensor(name).values.data() : nullptr;
}

}  // extern "C"

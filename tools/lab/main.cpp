#include "hqslam/nn/compare/compared_networks.h"
#include "laboratory.h"

int main(int argc, char** argv) {
  using namespace hqslam::tools;
  hqslam::nn::add_compared_networks();
  return run_program<LaboratoryCommands>(laboratory_text(), argc, argv);
}

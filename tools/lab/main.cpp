#include "laboratory.h"

int main(int argc, char** argv) {
  using namespace hqslam::tools;
  return run_program<LaboratoryCommands>(laboratory_text(), argc, argv);
}

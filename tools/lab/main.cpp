#include "laboratory.h"

int main(int argc, char** argv) {
  return hqslam::tools::run_program(hqslam::tools::laboratory(), argc, argv);
}

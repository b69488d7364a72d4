#include "product.h"

int main(int argc, char** argv) {
  return hqslam::tools::run_program(hqslam::tools::product(), argc, argv);
}

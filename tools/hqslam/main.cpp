#include "product.h"

int main(int argc, char** argv) {
  using namespace hqslam::tools;
  return run_program<ProductCommands>(product_text(), argc, argv);
}

#include "seeds.h"

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  hqslam::fuzz::write_seeds(argv[1]);
  return 0;
}

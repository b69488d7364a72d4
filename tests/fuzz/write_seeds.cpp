#include "seeds.h"

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  hqslam::fuzz::write_seeds(argv[1], argv[2]);
  return 0;
}

#include "command_line.h"

int main(int argc, char** argv) { return hqslam::tools::run_program(argc, argv); }

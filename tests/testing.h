#pragma once

// What tests use from everywhere, so that a test includes only what it tests and what its subject
// takes.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <numeric>
#include <optional>
#include <random>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <tuple>
#include <utility>
#include <vector>

#include "error_message.h"
#include "file_contents.h"
#include "temporary_directory.h"

namespace hqslam::test {}
using namespace hqslam;
using namespace hqslam::test;

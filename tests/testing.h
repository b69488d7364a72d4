#pragma once

// What nearly every test uses, so that a test includes only what it tests and what its subject
// takes.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "error_message.h"
#include "file_contents.h"
#include "temporary_directory.h"

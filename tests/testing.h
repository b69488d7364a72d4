#pragma once

// What nearly every test uses.
#include <doctest/doctest.h>

#include "error_message.h"
#include "file_contents.h"
#include "temporary_directory.h"

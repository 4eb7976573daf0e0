#pragma once
// A test that takes more than about five seconds: ctest gives it the label slow (tests/CMakeLists.txt).
#include <gtest/gtest.h>

#define SLOW_TEST TEST

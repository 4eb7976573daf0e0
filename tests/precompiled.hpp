#pragma once
// What nearly every test reads, parsed once for all of them. Nothing relies on it: each file includes what it
// uses.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "../cmake/precompiled.hpp"

#pragma once
// Findings by their names.
#include <gtest/gtest.h>

#include <algorithm>
#include <string_view>

#include "models/motion.hpp"

namespace rabiline::test {

inline const Finding* find(const ModelResult& result, std::string_view name) {
  const auto found = std::find_if(result.findings.begin(), result.findings.end(),
                                  [&](const Finding& f) { return f.name == name; });
  return found == result.findings.end() ? nullptr : &*found;
}
/// One that must be there.
inline Finding finding(const ModelResult& result, std::string_view name) {
  const Finding* f = find(result, name);
  EXPECT_NE(f, nullptr) << name;
  return f ? *f : Finding{};
}

}  // namespace rabiline::test

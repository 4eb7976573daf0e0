#pragma once
// The one way to test physics: a result agrees with the reference, and does not agree with the reference for
// a constant that is off by 1 %, so that the test is seen to be able to fail.
#include <gtest/gtest.h>

#include <cmath>

namespace rabiline::test {

/// `reference(scale)` gives the expected value with the constant under test multiplied by `scale`.
template <class Reference>
void expect_agreement(double result, Reference reference, double tolerance, const char* what) {
  EXPECT_NEAR(result, reference(1.0), tolerance) << what;
  EXPECT_GT(std::abs(result - reference(1.01)), tolerance)
      << what << ": the test could not see an error of 1 %";
}

}  // namespace rabiline::test

#pragma once
// Elementary functions that give the same bits on every processor. The C library picks its variant of sin,
// exp, pow and their like at run time, by whether the processor has a fused multiply-add, and the variants
// differ in the last bit; numbers that a kernel or a result will see come from here instead.
//
// These are the kernels' own functions (core/lanes.hpp), one lane wide, and what is composed of them. Square
// root, floor, fma, ldexp, remainder and their like are exact or correctly rounded wherever they come from:
// std serves for them. Errors are those of tests/unit/core/portable_math_test.cpp; eps is 2.2e-16.

namespace rabiline::portable {

/// |x| <= 1e9: error below eps, and relative to the value below eps within a turn of zero.
double sin(double x);
double cos(double x);
/// Relative error below 4 eps for |x| <= 10.
double tan(double x);
/// Error below 2 eps of the value or of 1, whichever is larger.
double atan(double x);
double asin(double x);
double acos(double x);
/// The angle of (x, y), between -pi and pi; 0 or pi for the origin. Error below 4 eps.
double atan2(double y, double x);

/// Relative error below 4 eps wherever the result is a normal number.
double exp(double x);
/// Relative error below 2 eps.
double log(double x);
/// Relative error below 8 eps.
double asinh(double x);
/// Of a positive x. Relative error below (4 + 2 |y log x|) eps.
double pow(double x, double y);
/// By multiplication. Relative error below |n| eps.
double pow(double x, int n);
/// Relative error below 8 eps.
double erf(double x);

/// Relative error below 2 eps, without overflow on the way.
double hypot(double x, double y, double z = 0);

}  // namespace rabiline::portable

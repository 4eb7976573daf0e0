#pragma once
// ComplexNumber numbers of any number type, for fields across two coordinates: std::complex is not for
// kernels.
namespace rabiline {

template <class Number>
struct ComplexNumber {
  Number re, im;
  [[gnu::always_inline]] friend ComplexNumber operator+(const ComplexNumber& a, const ComplexNumber& b) {
    return {a.re + b.re, a.im + b.im};
  }
  [[gnu::always_inline]] friend ComplexNumber operator-(const ComplexNumber& a, const ComplexNumber& b) {
    return {a.re - b.re, a.im - b.im};
  }
  [[gnu::always_inline]] friend ComplexNumber operator*(const ComplexNumber& a, const ComplexNumber& b) {
    return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
  }
  [[gnu::always_inline]] friend ComplexNumber operator*(double s, const ComplexNumber& a) {
    return {s * a.re, s * a.im};
  }
  [[gnu::always_inline]] friend ComplexNumber operator+(const ComplexNumber& a, double b) {
    return {a.re + b, a.im};
  }
};

}  // namespace rabiline

#pragma once
// Complex numbers of any number type, for fields across two coordinates: std::complex is not for kernels.
namespace rabiline {

template <class Number>
struct Complex {
  Number re, im;
  [[gnu::always_inline]] friend Complex operator+(const Complex& a, const Complex& b) {
    return {a.re + b.re, a.im + b.im};
  }
  [[gnu::always_inline]] friend Complex operator-(const Complex& a, const Complex& b) {
    return {a.re - b.re, a.im - b.im};
  }
  [[gnu::always_inline]] friend Complex operator*(const Complex& a, const Complex& b) {
    return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
  }
  [[gnu::always_inline]] friend Complex operator*(double s, const Complex& a) { return {s * a.re, s * a.im}; }
  [[gnu::always_inline]] friend Complex operator+(const Complex& a, double b) { return {a.re + b, a.im}; }
};

}  // namespace rabiline
